"""What became of sessions and services, and who chose a reference."""

from pydantic import BaseModel, ConfigDict, Field

from service.api.schemas.fields import Name, Reason, Text
from service.records.state import RecordState, StateChange


class StateList(BaseModel):
    """The life of a session."""

    session: str = Field(description="Its id.")
    state: RecordState = Field(description="What it is now. Only an accepted session tells of its unit.")
    states: tuple[StateChange, ...] = Field(description="Oldest first; empty where it was accepted and remained so.")


class Correcting(BaseModel):
    """Who has a questioned session's file put right."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"example": {"by": "K. Ito"}})

    by: Name = Field(description="Who says so.")


class Superseding(BaseModel):
    """Which session stands for another one, who says so and why."""

    model_config = ConfigDict(
        extra="forbid",
        json_schema_extra={
            "example": {"by": "K. Ito", "why": "alpha mistyped", "superseded_by": "3f9a0c5be1d24786aa10"}
        },
    )

    by: Name = Field(description="Who says so.")
    why: Reason = Field(description="Why; what was wrong.")
    superseded_by: Text | None = Field(
        default=None,
        description="The session that counts from now on. It can be left out where only one was uploaded later of the "
        "same unit, programme and date.",
    )


class NewReference(BaseModel):
    """The session that an engineer chooses as the reference of its epoch."""

    model_config = ConfigDict(
        extra="forbid",
        json_schema_extra={
            "example": {"session": "3f9a0c5be1d24786aa10", "by": "K. Ito", "why": "the first one was measured warm"}
        },
    )

    session: Text = Field(description="Its id; it must be accepted and give an uncertainty.")
    by: Name = Field(description="Who chooses and approves it.")
    why: Reason = Field(description="Why.")


class DerivationSchema(BaseModel):
    """How far what is known of a unit follows its records."""

    unit: str = Field(description="Serial number of the unit.")
    sessions: int = Field(description="Its accepted sessions.")
    waiting: int = Field(description="Those that are still to be judged again after a change of its records.")
