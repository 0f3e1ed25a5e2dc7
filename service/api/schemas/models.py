"""Diagnoses, accepted causes as model revisions, and what became of recomputed sessions."""

from datetime import datetime
from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

from service.api.schemas.fields import LongText, Name
from service.records.decision import Verdict
from service.records.diagnosis import DiagnosisState
from service.records.model import Scope
from service.records.recomputation import Progress
from service.storage.diagnosis_document import evidence_to_dict


def _with_a_space(scope: Any) -> Any:
    """``unit-type`` and ``unit_type`` are ``unit type``."""
    return scope.replace("-", " ").replace("_", " ") if isinstance(scope, str) else scope


AnyScope = Annotated[Scope, BeforeValidator(_with_a_space)]
AnyEvidence = Annotated[dict[str, Any], BeforeValidator(evidence_to_dict)]


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


class ModelSchema(BaseModel):
    """One accepted or withdrawn cause: a numbered revision of a model."""

    model_config = ConfigDict(from_attributes=True)

    id: int = Field(description="Number of the revision; all models are numbered through.")
    scope: Scope = Field(description="Whose model it is.")
    subject: str = Field(description="Serial number of the unit, or name of the unit type or of the stand.")
    cause: str = Field(description="Identifier of the cause.")
    sensors: list[str] = Field(description="Sensors that it acts on; none for a cause of stand or fixture.")
    session: str = Field(description="The session that showed it.")
    evidence: AnyEvidence = Field(
        description="p-value, strength, amplitude with sigma, and gain of the finding; `pooled`: what a group of "
        "sessions told beside, null where a single session showed it."
    )
    accepted_by: str = Field(description="Who accepted it.")
    note: str = Field(description="Why.")
    accepted_at: datetime = Field(description="When, UTC.")
    withdraws: int | None = Field(description="The revision that this one withdraws; null for an accepted cause.")


class MovedVerdictSchema(BaseModel):
    """A session that has another verdict since."""

    model_config = ConfigDict(from_attributes=True)

    session: str = Field(description="Id of the session.")
    started_at: datetime = Field(description="When it was measured.")
    before: Verdict = Field(description="Its verdict before.")
    after: Verdict = Field(description="Its verdict since.")


class MovedParameterSchema(BaseModel):
    """The parameter of a unit that moved furthest, in its own standard uncertainty."""

    model_config = ConfigDict(from_attributes=True)

    session: str = Field(description="Id of the session.")
    sensor: str = Field(description="Name of the sensor.")
    kind: str = Field(description="`accelerometer` or `gyroscope`.")
    parameter: str = Field(description="`scale`, `bias`, `quadratic`, `axis` or `misalignment`.")
    change: float = Field(description="SI; relative of a scale factor, rad of an axis.")
    u: float = Field(description="Its standard uncertainty.")


class RecomputedSchema(BaseModel):
    """What became of a unit's sessions."""

    model_config = ConfigDict(from_attributes=True)

    sessions: int = Field(description="How many it has.")
    recomputed: int = Field(description="How many have another calibration.")
    left: int = Field(description="How many cannot be calibrated under the model, and keep what they have.")
    verdicts: list[MovedVerdictSchema] = Field(description="Sessions that have another verdict since.")
    furthest: MovedParameterSchema | None = Field(description="What moved most; null where nothing moved.")


class RecomputationSchema(BaseModel):
    """A unit's part of what a revision brought."""

    model_config = ConfigDict(from_attributes=True)

    unit: str = Field(description="Serial number.")
    state: Progress = Field(description="`waiting`, `done`, or `given up`: then its sessions keep what they had.")
    done_at: datetime | None = Field(description="When, UTC; null while it waits.")
    outcome: RecomputedSchema | None = Field(description="What became of its sessions; null until it is done.")
    failed: str = Field(description="Why the last try failed; empty where none did.")


class ModelAndRecomputations(ModelSchema):
    """A revision with what it brought."""

    recomputations: list[RecomputationSchema] = Field(
        description="Units whose sessions are computed again because of it: of what groups of sessions show."
    )


class ModelPage(BaseModel):
    """One page of model revisions, newest first."""

    models: list[ModelSchema] = Field(description="The revisions of this page.")
    page: int = Field(description="Which page this is, from 1.")
    limit: int = Field(description="How many fit on a page.")
    next_page: int | None = Field(description="The next page; null after the last.")


class RecalibratedSchema(BaseModel):
    """What became of a unit's stored sessions."""

    model_config = ConfigDict(from_attributes=True)

    unit: str = Field(description="Serial number of the unit.")
    sessions: int = Field(description="How many it has.")
    recomputed: int = Field(description="How many have a new calibration under the model in force.")
    unchanged: int = Field(description="How many had one already.")
    left: int = Field(description="How many cannot be calibrated under it and keep what they have.")
    revision: int = Field(description="The latest model revision that any of them rests on; 0 is the baseline.")
