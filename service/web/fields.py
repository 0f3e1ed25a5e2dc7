"""Types of values in requests."""

import re
from dataclasses import dataclass
from datetime import UTC, date, datetime
from typing import Annotated, Any

from fastapi import Depends, Path, Query
from pydantic import AfterValidator, BaseModel, BeforeValidator, Field, GetCoreSchemaHandler, StringConstraints
from pydantic.annotated_handlers import GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema
from pydantic_core.core_schema import no_info_after_validator_function

from service.kit.moments import EARLIEST, EPOCH, LATEST, MILLISECOND, aware, in_utc
from service.kit.text import NUL, OF_A_LINE, OF_LINES, fault_of_text, with_plain_ends
from service.sessions.decision import Verdict

NUMBER = re.compile(r"\s*[-+]?[\d._]+(e[-+]?\d+)?\s*", re.IGNORECASE)
FEWEST_MS = 100_000_000_000
"""Least number taken for milliseconds: in milliseconds a day of March 1973, long before any measurement; in seconds the
year 5138.
"""
MOST_MS = 7_258_118_400_000
"""The start of 2200, the latest date stored."""


def _counted(value: object) -> object:
    """A bound may be in milliseconds since 1970, as dashboards send it. Seconds would lie in 1970 and are refused,
    since they would select nothing, or everything."""
    if not isinstance(value, str) or not value.isdecimal():
        return _written(value)
    if int(value) < FEWEST_MS:
        raise ValueError("a bare number is milliseconds since 1970; of seconds, write the date and time")
    return EPOCH + min(int(value), MOST_MS) * MILLISECOND


def _bounded(moment: datetime) -> datetime:
    """No date before 1900 or after 2200 is stored: a bound beyond selects the same."""
    return min(max(aware(moment), EARLIEST), LATEST).astimezone(UTC)


def _written(value: object) -> object:
    """A bare number would be taken for seconds since 1970."""
    if isinstance(value, int | float) or (isinstance(value, str) and NUMBER.fullmatch(value)):
        raise ValueError("must be a date and time like 2026-03-01T09:00:00Z")
    return value


def _day_written(value: object) -> object:
    if isinstance(value, int | float) or (isinstance(value, str) and NUMBER.fullmatch(value)):
        raise ValueError("must be a day like 2026-03-01")
    return value


Moment = Annotated[datetime, BeforeValidator(_written), AfterValidator(in_utc)]
"""A time; UTC without a zone."""
Bound = Annotated[datetime, BeforeValidator(_counted), AfterValidator(_bounded)]
"""First or last time of a list; UTC without a zone. Also in milliseconds since 1970."""
Day = Annotated[date, BeforeValidator(_day_written)]


@dataclass(frozen=True)
class Typed:
    """A rule for a text: characters that it must not contain, and whether it says anything."""

    refused: str
    """Characters that the text must not contain, as inside the brackets of a regular expression."""
    is_required: bool = False
    """Whether it must have more than spaces."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return no_info_after_validator_function(self._checked, handler(source))

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        one = f"[^{self.refused}]*"
        return {**handler(schema), "pattern": f"^{one}[^\\s{self.refused}]{one}$" if self.is_required else f"^{one}$"}

    def _checked(self, text: str) -> str:
        fault = fault_of_text(text, self.refused, is_required=self.is_required)
        if fault is not None:
            raise ValueError(fault)
        return text if self.refused == OF_A_LINE else with_plain_ends(text)


Sought = Annotated[str, StringConstraints(max_length=200), Typed(NUL)]
"""A text to look for: an earlier release stored other characters than `Text` allows."""
Text = Annotated[str, StringConstraints(max_length=200), Typed(OF_A_LINE)]
LongText = Annotated[str, StringConstraints(max_length=2000), Typed(OF_LINES)]
Name = Annotated[str, StringConstraints(max_length=200), Typed(OF_A_LINE, is_required=True)]
Reason = Annotated[str, StringConstraints(max_length=2000), Typed(OF_LINES, is_required=True)]
Number = Annotated[int, Path(ge=1, le=2_000_000_000, description="Number of the entry.", examples=[1])]

SessionId = Annotated[
    Sought,
    Path(
        description="The session's id: the first 20 digits of its file's SHA-256.",
        examples=["3f9a0c5be1d24786aa10"],
    ),
]
Serial = Annotated[Sought, Path(description="The unit's serial number.", examples=["BA-017"])]
TypeName = Annotated[Sought, Path(description="The unit type's name.", examples=["hex-cone"])]
StandName = Annotated[
    Sought,
    Path(description="The stand's name, as session files give it.", examples=["ODG-1"]),
]
Page = Annotated[int, Query(ge=1, le=1_000_000, description="Which page, from 1.")]
Limit = Annotated[int, Query(ge=1, le=1000, description="How many on a page.")]
Revision = Annotated[
    int | None,
    Query(ge=0, le=2_000_000_000, description="Under this model revision instead of the one in force; 0: baseline."),
]
WantedVerdict = Annotated[Verdict | None, Query(description="Only units whose latest session has this verdict.")]
WantedText = Annotated[Sought | None, Query(alias="q", description="Part of a serial number or of a unit type's name.")]


@dataclass(frozen=True)
class Window:
    """Requested part of a list."""

    page: int
    limit: int

    @property
    def offset(self) -> int:
        """Number of entries before it."""
        return (self.page - 1) * self.limit

    def next_after(self, count: int) -> int | None:
        """The number of the next page; None after one that is not full."""
        return self.page + 1 if count == self.limit else None

    def place(self, count: int) -> dict[str, Any]:
        """Fields of a `Paged` answer."""
        return {"page": self.page, "limit": self.limit, "next_page": self.next_after(count)}


class Body(BaseModel, extra="forbid"):
    """Body of a request: an unknown field is refused."""


class Paged(BaseModel):
    """One page of a list."""

    page: int = Field(description="Which page this is, from 1.")
    limit: int = Field(description="How many fit on a page.")
    next_page: int | None = Field(description="The next page; null after the last.")


def _window(page: Page = 1, limit: Limit = 100) -> Window:
    return Window(page, limit)


WindowOf = Annotated[Window, Depends(_window)]
