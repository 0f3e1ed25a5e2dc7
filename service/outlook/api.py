"""The calendar of due dates, to subscribe to (iCalendar, RFC 5545).

Written line by line: a library that builds every property as an object takes thirty times as long for a fleet.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from datetime import UTC, date, datetime, timedelta
from urllib.parse import quote
from uuid import NAMESPACE_URL, uuid5

from fastapi import APIRouter, Request, Response

from service.fleet.condition import UnitSummary
from service.fleet.records import FleetQuery, Order
from service.fleet.store import Fleet
from service.judging.records import Usable
from service.judging.usable_reading import usable_of
from service.kit.text import without_control
from service.outlook.changes import END_OF_TIME
from service.web.dependencies import Now, Reading
from service.web.problem_document import errors

HEAD = (
    "BEGIN:VCALENDAR",
    "VERSION:2.0",
    "PRODID:-//imu-health//due dates//EN",
    "CALSCALE:GREGORIAN",
    "METHOD:PUBLISH",
    "X-WR-CALNAME:Calibrations due",
)
ESCAPED = str.maketrans({"\\": r"\\", ";": r"\;", ",": r"\,", "\n": r"\n"})
"""Section 3.3.11."""
LONGEST = 75
"""Bytes of a line without its end (section 3.1); a longer one continues in the next, which begins with a blank."""
CONTINUES = 0b10
"""The highest two bits of a byte within a character of UTF-8."""


@dataclass(frozen=True)
class DueDay:
    """One event."""

    unit: str
    day: date
    summary: str
    description: str
    url: str


def calendar(days: Iterable[DueDay], now: datetime) -> bytes:
    """The calendar; an event's identifier is that of its unit, so that a new date moves the event."""
    events = (line for day in days for line in _event(day, f"{now.astimezone(UTC):%Y%m%dT%H%M%SZ}"))
    return b"".join(_folded(line) for line in (*HEAD, *events, "END:VCALENDAR"))


def _event(due: DueDay, now: str) -> Iterator[str]:
    yield "BEGIN:VEVENT"
    yield f"UID:{uuid5(NAMESPACE_URL, f'imu-health/due/{due.unit}')}@imu-health"
    yield f"DTSTAMP:{now}"
    yield f"DTSTART;VALUE=DATE:{due.day:%Y%m%d}"
    yield f"DTEND;VALUE=DATE:{due.day + timedelta(days=1):%Y%m%d}"
    yield f"SUMMARY:{_text(due.summary)}"
    yield f"DESCRIPTION:{_text(due.description)}"
    yield f"URL:{due.url}"
    yield "TRANSP:TRANSPARENT"
    yield "END:VEVENT"


def _text(value: str) -> str:
    return without_control(value).translate(ESCAPED)


def _folded(line: str) -> bytes:
    """A content line folded to its longest length, with its end; characters stay whole."""
    rest, parts, room = line.encode(), [], LONGEST
    while len(rest) > room:
        cut = room
        while rest[cut] >> 6 == CONTINUES:
            cut -= 1
        parts.append(rest[:cut])
        rest, room = rest[cut:], LONGEST - 1
    return b"\r\n ".join([*parts, rest]) + b"\r\n"


router = APIRouter(prefix="/feeds", tags=["feeds"])
CALENDAR = "text/calendar"
"""Media type (RFC 5545 section 8.1)."""
MOST_DAYS = 1000
"""Units in the calendar, the first that are due: years of work, and little to fetch every hour."""
TEXT = {"type": "string"}
"""OpenAPI schema of the answer."""


@router.get("/due.ics", responses={200: {"content": {CALENDAR: {"schema": TEXT}}}, **errors()}, response_class=Response)
def read_due_dates(request: Request, store: Reading, now: Now) -> Response:
    """The days on which calibrations are due, as a calendar: of the first 1,000 units, overdue ones before all."""
    units = Fleet(store).units(FleetQuery(order=Order.DUE, due_before=END_OF_TIME, limit=MOST_DAYS))
    uses = usable_of(store, units, now)
    days = [_due_day(uses[unit.serial], unit, str(request.base_url)) for unit in units]
    return Response(calendar(days, now), media_type=f"{CALENDAR}; charset=utf-8")


def _due_day(use: Usable, unit: UnitSummary, base: str) -> DueDay:
    """The rule that set the date, after what the unit may be used for."""
    assert use.until is not None
    return DueDay(
        unit=unit.serial,
        day=use.until.date(),
        summary=f"{unit.serial}: calibration {'overdue' if use.is_overdue else 'due'}",
        description=f"{use.use}. {use.due_reason}",
        url=f"{base}units/{quote(unit.serial)}",
    )
