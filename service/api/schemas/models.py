"""Diagnoses, accepted causes as model revisions, and what became of recomputed sessions."""

from collections.abc import Iterable
from dataclasses import dataclass
from datetime import datetime
from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

from service.api.schemas.fields import LongText, Name, Paged
from service.records.answer import answer
from service.records.decision import Verdict
from service.records.diagnosis import DiagnosisState
from service.records.model import ModelRevision, Scope
from service.records.recomputation import Recomputation
from service.storage.diagnosis_document import evidence_to_dict


def _with_a_space(scope: Any) -> Any:
    """``unit-type`` and ``unit_type`` are ``unit type``."""
    return scope.replace("-", " ").replace("_", " ") if isinstance(scope, str) else scope


AnyScope = Annotated[Scope, BeforeValidator(_with_a_space)]


class DiagnosisDocument(BaseModel):
    """imu-diagnosis/1: what the simulation gets wrong about a session, and how it was made."""

    format: str = Field(description="`imu-diagnosis/1`.")
    unit: str = Field(description="Serial number of the unit.")
    findings: list[dict[str, Any]] = Field(
        description="Named causes, strongest first: cause, sensors, amplitude and sigma in SI, p_value, alternatives "
        "(`unexplained`: a cause that is not in the catalogue), what would distinguish them, ranking, sentence, advice."
    )
    unexplained: bool = Field(description="Whether there is structure that no known cause explains.")
    structures: list[dict[str, Any]] = Field(
        description="Where that structure lives, no sensors where it is common to all. `course` is how the applied "
        "vector must have run: `order`, `components` (`β` and `α` in rad, `size` relative) and `values`, one list a "
        "row; null where nothing common was found. `of_record`: whether the record itself is mixed up."
    )
    noise: list[dict[str, Any]] = Field(
        default=[],
        description="Kinds of sensor whose stated standard errors the readings contradict: `kind`, `factor` by which "
        "they are too small (below 1 they are too large), and the degrees of `freedom` that tell it.",
    )
    gain: dict[str, Any] | None = Field(
        description="Prediction of readings that were held out, before and after, with `rms_by_kind` of sensor; null "
        "where causes are not looked for."
    )
    limits: list[dict[str, Any]] = Field(description="Smallest amplitude of each cause that would have been found.")
    calibration: dict[str, Any] | None = Field(
        description="imu-calibration/1 under the model with the named causes; null where causes are not looked for."
    )
    residuals_before: dict[str, Any] | None = Field(
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


class NewModelSchema(BaseModel):
    """A named cause that an engineer accepts into a model."""

    model_config = ConfigDict(
        extra="forbid",
        json_schema_extra={
            "example": {"cause": "bias-temperature", "scope": "unit", "by": "K. Ito", "note": "seen in three sessions"}
        },
    )

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

    evidence: dict[str, Any]  # type: ignore[assignment]  # as it is stored
    """p-value, strength, amplitude with sigma, and gain of the finding; `pooled`: what a group of sessions told beside,
    null where a single session showed it."""


@answer
@dataclass(frozen=True, kw_only=True)
class ModelAndRecomputations(ModelDocument):
    """A revision with what it brought."""

    recomputations: tuple[Recomputation, ...]
    """Units whose sessions are computed again because of it: of what groups of sessions show."""


def model_document(revision: ModelRevision) -> ModelDocument:
    """With its evidence as it is stored."""
    return ModelDocument(**_fields(revision))


def moved_by(revision: ModelRevision, recomputations: Iterable[Recomputation]) -> ModelAndRecomputations:
    """With what it brought."""
    return ModelAndRecomputations(**_fields(revision), recomputations=tuple(recomputations))


def _fields(revision: ModelRevision) -> dict[str, Any]:
    return {**vars(revision), "evidence": evidence_to_dict(revision.evidence)}


class ModelPage(Paged):
    """One page of model revisions, newest first."""

    models: list[ModelDocument] = Field(description="The revisions of this page.")
