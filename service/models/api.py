"""Model revisions over HTTP."""

from dataclasses import dataclass
from datetime import datetime
from typing import Annotated, Any

from fastapi import APIRouter, Query
from pydantic import BaseModel, BeforeValidator, Field

from estimator.json_object import Json
from service.flags.api import Handling
from service.kit.answer import answer
from service.models.records import ModelRevision, Recomputation, Scope
from service.models.store import ModelQuery, Models, Recomputations, evidence_to_dict
from service.people.admission import PersonOf
from service.records.dependencies import ReceptionOf
from service.records.models import withdraw_model
from service.records.recalibrate import recompute_beside
from service.sessions.decision import Verdict
from service.sessions.records import DiagnosisState
from service.web.dependencies import Now, Reading
from service.web.fields import Body, LongText, Name, Number, Paged, Sought, WindowOf
from service.web.problem_document import errors


def _with_a_space(scope: Any) -> Any:
    """``unit-type`` and ``unit_type`` are ``unit type``."""
    return scope.replace("-", " ").replace("_", " ") if isinstance(scope, str) else scope


AnyScope = Annotated[Scope, BeforeValidator(_with_a_space)]


class DiagnosisDocument(BaseModel):
    """imu-diagnosis/1: the diagnosis of a session, and how it was made."""

    format: str = Field(description="`imu-diagnosis/1`.")
    unit: str = Field(description="Serial number of the unit.")
    findings: list[Json] = Field(
        description="Named causes, strongest first: cause, sensors, amplitude and sigma in SI, p_value, alternatives "
        "(`unexplained`: a cause that is not in the catalogue), what would distinguish them, ranking, sentence, advice."
    )
    unexplained: bool = Field(description="Whether there is structure that no known cause explains.")
    structures: list[Json] = Field(
        description="Where that structure lives, no sensors where it is common to all. `course` is how the applied "
        "vector must have run: `order`, `components` (`β` and `α` in rad, `size` relative) and `values`, one list a "
        "row; null where nothing common was found. `of_record`: whether the record itself is mixed up."
    )
    noise: list[Json] = Field(
        default=[],
        description="Kinds of sensor whose stated standard errors the readings contradict: `kind`, `factor` by which "
        "they are too small (below 1 they are too large), and the degrees of `freedom` that tell it.",
    )
    gain: Json | None = Field(
        description="Prediction of readings that were held out, before and after, with `rms_by_kind` of sensor and "
        "`rms_by_sensor`, by kind and name, in SI; null where causes are not looked for."
    )
    gain_in_words: str = Field(
        default="", description="The same of the sensors concerned in one sentence; empty where no cause is named."
    )
    limits: list[Json] = Field(description="Smallest amplitude of each cause that would have been found.")
    calibration: Json | None = Field(
        description="imu-calibration/1 under the model with the named causes; null where causes are not looked for."
    )
    residuals_before: Json | None = Field(
        description="Measured minus simulated under the baseline model; null where causes are not looked for."
    )
    notes: list[str] = Field(description="What else is worth knowing.")
    session: str = Field(description="Id of the session.")
    state: DiagnosisState = Field(description="What it came to.")
    summary: str = Field(description="The same in one line.")
    verdict_after: Verdict | None = Field(description="The session's verdict with the named causes in the model.")
    model_revision: int = Field(description="Model revision in force when it was made; 0 is the baseline.")
    estimator_version: str = Field(description="Version of the program that made it.")
    created_at: datetime = Field(description="When, UTC.")


class PendingDiagnosis(BaseModel):
    """A diagnosis that is still being made."""

    session: str = Field(description="Id of the session.")
    status: str = Field(description="`pending`: ask again after the seconds in Retry-After.")


class NewModelSchema(
    Body,
    json_schema_extra={
        "example": {"cause": "bias-temperature", "scope": "unit", "by": "K. Ito", "note": "seen in three sessions"}
    },
):
    """A named cause that an engineer accepts into a model."""

    cause: Name = Field(
        description="Identifier of a cause of the catalogue that the session's diagnosis names or lists as alternative."
    )
    scope: AnyScope = Field(description="Whose model: the unit's, that of all units of its type, or the stand's.")
    by: Name = Field(description="Who accepts it.")
    note: LongText = Field(default="", description="Why.")


@answer
@dataclass(frozen=True)
class ModelDocument(ModelRevision):
    """One accepted or withdrawn cause: a numbered revision of a model."""

    evidence: Json  # type: ignore[assignment]  # as it is stored
    """p-value, strength, amplitude with sigma, and gain of the finding; `pooled`: facts from a group of sessions, null
    where a single session showed it.
    """


@answer
@dataclass(frozen=True, kw_only=True)
class ModelAndRecomputations(ModelDocument):
    """A revision with its effects."""

    recomputations: tuple[Recomputation, ...]
    """Units whose sessions are computed again because of it."""


def model_document(revision: ModelRevision) -> ModelDocument:
    """A revision with its evidence as stored."""
    return ModelDocument(**_fields(revision))


def _fields(revision: ModelRevision) -> dict[str, Any]:
    return {**vars(revision), "evidence": evidence_to_dict(revision.evidence)}


class ModelPage(Paged):
    """One page of model revisions, newest first."""

    models: list[ModelDocument] = Field(description="The revisions of this page.")


router = APIRouter(prefix="/models", tags=["models"])


@router.post("/{id}/withdraw", status_code=201, responses=errors(400, 404, 409, 422))
def withdraw_cause(id: Number, handling: Handling, reception: ReceptionOf, now: Now, person: PersonOf) -> ModelDocument:
    """Take an accepted cause out of the model: a revision of its own; sessions are calibrated without, the stored ones
    anew.
    """
    withdrawal = withdraw_model(reception.storage, id, person.signs(handling.by), handling.why, now)
    recompute_beside(reception, now)
    return model_document(withdrawal)


@router.get("/{id}", responses=errors(404, 422))
def read_model(id: Number, store: Reading) -> ModelAndRecomputations:
    """One revision, with its effects on the sessions that it concerns."""
    return ModelAndRecomputations(**_fields(Models(store).get(id)), recomputations=tuple(Recomputations(store).of(id)))


@router.get("", responses=errors(422))
def list_models(
    store: Reading,
    window: WindowOf,
    scope: Annotated[Scope | None, Query(description="Only models of units, of unit types or of stands.")] = None,
    subject: Annotated[Sought | None, Query(description="Only of this unit, unit type or stand.")] = None,
) -> ModelPage:
    """Accepted causes, newest first."""
    revisions = Models(store).page(ModelQuery(scope, subject, window.offset, window.limit))
    return ModelPage(models=list(map(model_document, revisions)), **window.place(len(revisions)))
