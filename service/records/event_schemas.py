"""Services of units, notes on their histories, and sessions as found and as left."""

from typing import Literal

from pydantic import BaseModel, Field

from service.sessions.schemas import DecisionSchema, SaidSession
from service.units.records import Note
from service.web.fields import Body, LongText, Moment, Name, Reason, Text

ServiceKind = Literal["adjustment", "repair", "sensor-swap", "reference", "service"]
Stage = Literal["as-found", "as-left"]


class NewServiceSchema(
    Body,
    json_schema_extra={
        "example": {
            "kind": "sensor-swap",
            "at": "2026-02-10T12:00:00Z",
            "sensor": "A3",
            "by": "K. Ito",
            "note": "A3 replaced after a fall",
        }
    },
):
    """A known break in a unit's history; the next session measured after it is the new reference."""

    kind: ServiceKind = Field(description="What was done; `reference` is a new reference set, `service` anything else.")
    at: Moment | None = Field(default=None, description="When; now if not given. Without a zone it is UTC.")
    note: LongText = Field(default="", description="Why, what exactly.")
    by: Text = Field(default="", description="Who did it.")
    sensor: Text = Field(default="", description="The sensor that it concerns; empty for the whole unit.")


class NewNote(
    Body, json_schema_extra={"example": {"text": "moved by road", "at": "2026-02-10T12:00:00Z", "by": "K. Ito"}}
):
    """A remark on a unit's history."""

    text: Reason = Field(description="What is worth knowing.")
    by: Name = Field(description="Who says it.")
    at: Moment | None = Field(default=None, description="The date it is about; now if not given.")


class NoteList(BaseModel):
    """All notes of a unit, oldest first."""

    unit: str = Field(description="Serial number of the unit.")
    notes: tuple[Note, ...] = Field(description="The notes, withdrawn ones too.")


class NewStage(Body, json_schema_extra={"example": {"stage": "as-found", "by": "K. Ito"}}):
    """Stage of a session: its unit as found, as left or neither."""

    stage: Stage | None = Field(description="Before or after the unit was worked on; null for neither.")
    by: Name = Field(description="Who says so.")


class FoundAndLeftLine(BaseModel):
    """One parameter as found and as left."""

    found: DecisionSchema = Field(description="Judged as found.")
    left: DecisionSchema | None = Field(description="Judged as left, against the same reference; null before that.")


class FoundAndLeftSchema(BaseModel):
    """A unit as it was found and as it was left."""

    reference: str | None = Field(description="The session that both are judged against.")
    found: SaidSession | None = Field(description="The latest as-found session; null where there is none.")
    left: SaidSession | None = Field(description="The first as-left session after it.")
    parameters: list[FoundAndLeftLine] = Field(description="Every judged parameter, sensor after sensor.")
