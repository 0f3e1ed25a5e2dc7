"""Flags and what happens to them."""

from datetime import datetime
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from service.api.schemas.fields import LongText, Name, Reason, Text
from service.records.flag import FlagState, Matter, NoticeKind
from service.records.model import Scope

FlagNumber = Annotated[int, Field(ge=1, le=2_000_000_000)]


class NoticeSchema(BaseModel):
    """One change of a flag."""

    model_config = ConfigDict(from_attributes=True)

    kind: NoticeKind = Field(description="What happened.")
    at: datetime = Field(description="When, UTC.")
    who: str = Field(description="Through whom; `imu-health` for the service itself.")
    text: str = Field(description="What was seen, or why it was done.")
    session: str | None = Field(description="The session that it follows from, if one does.")


class FlagSchema(BaseModel):
    """A matter that somebody must look after."""

    model_config = ConfigDict(from_attributes=True)

    id: int = Field(description="Number of the flag.")
    unit: str = Field(description="Serial number of the unit; of another scope, of the unit that showed it last.")
    scope: Scope = Field(description="Whether it is about the unit, its whole unit type or a stand.")
    subject: str = Field(description="Name of the unit type or the stand; empty where it is about the unit.")
    matter: Matter = Field(description="What it is about.")
    place: str = Field(description="The sensor or the stand that it is about; empty for the unit as a whole.")
    state: FlagState = Field(description="`raised`, `acknowledged` or `resolved`.")
    summary: str = Field(description="The matter as the latest session shows it, in a sentence or two.")
    proposal: str = Field(description="Why it could be resolved; empty while nothing speaks for it.")
    session: str | None = Field(description="The latest session that showed it.")
    raised_at: datetime = Field(description="When it was first raised, UTC.")
    changed_at: datetime = Field(description="When it last changed, UTC.")
    assignee: str = Field(description="Who is to look after it; empty where nobody in particular is.")
    changes: list[NoticeSchema] = Field(description="Its life, oldest first; nothing of it is ever changed.")


class FlagPage(BaseModel):
    """One page of flags: open ones first, newest first."""

    flags: list[FlagSchema] = Field(description="The flags of this page.")
    page: int = Field(description="Which page this is, from 1.")
    limit: int = Field(description="How many fit on a page.")
    next_page: int | None = Field(description="The next page; null after the last.")


class Assigning(BaseModel):
    """Who is to look after a flag."""

    model_config = ConfigDict(
        extra="forbid", json_schema_extra={"example": {"to": "k.ito", "by": "K. Ito", "why": "knows the stand"}}
    )

    to: Text = Field(description="Login or name of an account, any name where there are none; empty for nobody.")
    by: Name = Field(description="Who says so.")
    why: LongText = Field(default="", description="Why.")


class AssigningSeveral(Assigning):
    """Who is to look after several flags."""

    flags: list[FlagNumber] = Field(min_length=1, max_length=200, description="Numbers of the flags.")


class Assigned(BaseModel):
    """What became of several flags."""

    changed: int = Field(description="How many have another assignee now; resolved ones are left alone.")


class Handling(BaseModel):
    """Who does something, and why."""

    model_config = ConfigDict(
        extra="forbid", json_schema_extra={"example": {"by": "K. Ito", "why": "replacement sensor ordered"}}
    )

    by: Name = Field(description="Who does it.")
    why: Reason = Field(description="Why; what was found or done.")
