"""Flags and what happens to them."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from service.api.schemas.fields import LongText, Name, Paged, Reason, Text
from service.records.flag import Flag

FlagNumber = Annotated[int, Field(ge=1, le=2_000_000_000)]


class FlagPage(Paged):
    """One page of flags: open ones first, newest first."""

    flags: tuple[Flag, ...] = Field(description="The flags of this page.")


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
