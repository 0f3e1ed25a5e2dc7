"""What groups of sessions show."""

from datetime import datetime
from typing import Any

from pydantic import BaseModel, ConfigDict, Field

from service.api.schemas.fields import LongText, Name


class NotPooled(BaseModel):
    """An accepted session that is not in the pool."""

    session: str = Field(description="Its id.")
    reason: str = Field(description="Why; empty where its file is lost, or it could not be diagnosed.")


class GroupDocument(BaseModel):
    """imu-fleet-diagnosis/1: what the sessions of a unit, a unit type or a stand show together."""

    format: str = Field(description="`imu-fleet-diagnosis/1`.")
    level: str = Field(description="`unit`, `type` or `stand`.")
    id: str = Field(description="Serial number of the unit, name of the type or stand.")
    sessions: int = Field(
        description="How many are pooled: accepted ones that calibrate a block. Of a stand also those of the same "
        "units elsewhere, which tell whose an effect is."
    )
    first: str | None = Field(description="Start of the oldest one; null without any.")
    last: str | None = Field(description="Start of the newest one; null without any.")
    findings: list[dict[str, Any]] = Field(
        description="Lasting effects: cause, level, subject, sensors (`*`: every one of a kind), amplitude and sigma "
        "in SI, spread between sessions, form (`same`, `varying`, `since`), since, e_value, strength, alternatives, "
        "rivals with what to measure, sentence, advice, and every session's own amplitude."
    )
    terms: list[dict[str, Any]] = Field(description="Empirical terms, learned where the catalogue ends.")
    unexplained: bool = Field(description="Whether the sessions share structure that no known cause explains.")
    structures: list[dict[str, Any]] = Field(description="Where that structure lives, and how strong it is.")
    limits: list[dict[str, Any]] = Field(
        description="Smallest amplitude of each cause that the pool would have found; `one_session`: its latest one."
    )
    gain: dict[str, Any] | None = Field(
        description="Prediction of the later sessions with and without the findings; null without findings."
    )
    e_value: float = Field(description="Evidence for anything beside the findings; a name needs 100.")
    notes: list[str] = Field(description="What else is worth knowing.")
    left_out: int = Field(description="Older sessions that are not pooled: the newest 60 are.")
    not_pooled: list[NotPooled] = Field(description="Newer ones that are not, and why.")
    summary: str = Field(description="The same in one line.")
    estimator_version: str = Field(description="Version of the program that made it.")
    created_at: datetime = Field(description="When, UTC.")


class NewLastingSchema(BaseModel):
    """A lasting effect that an engineer accepts into the model of the unit, the unit type or the stand that has it."""

    model_config = ConfigDict(
        extra="forbid", json_schema_extra={"example": {"cause": "beta-eccentricity", "by": "K. Ito", "note": "encoder"}}
    )

    cause: Name = Field(description="Identifier of a cause that the sessions show together.")
    sensors: list[Name] = Field(
        default=[], description="Of the finding, where the cause alone does not say which one is meant."
    )
    by: Name = Field(description="Who accepts it.")
    note: LongText = Field(default="", description="Why.")


class PendingGroup(BaseModel):
    """An answer that is still being made."""

    level: str = Field(description="`unit`, `type` or `stand`.")
    id: str = Field(description="Serial number of the unit, name of the type or stand.")
    status: str = Field(description="`pending`: ask again after the seconds in Retry-After.")


PENDING: dict[int | str, dict[str, Any]] = {
    202: {"model": PendingGroup, "description": "Still being made; ask again after Retry-After seconds."}
}
"""How OpenAPI describes the answer while it is being made."""
