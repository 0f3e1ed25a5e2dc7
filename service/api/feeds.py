"""Feeds that people's own tools subscribe to: flags and verdicts as Atom, due dates as a calendar."""

from urllib.parse import quote

from fastapi import APIRouter, Request, Response

from service.api.atom import atom_feed
from service.api.calendar import DueDay, calendar
from service.api.schemas.problem import errors
from service.dependencies import Now, Reading

router = APIRouter(prefix="/feeds", tags=["feeds"])
ATOM, CALENDAR = "application/atom+xml", "text/calendar"
"""Media types (RFC 4287 section 8, RFC 5545 section 8.1)."""
MOST_ENTRIES = 200
"""Months of a fleet of a hundred units, and little to fetch every hour."""
MOST_DAYS = 1000
"""Units in the calendar, the first that are due: years of work, and little to fetch every hour."""
TEXT = {"type": "string"}
"""What the description says of both."""


@router.get("/flags.atom", responses={200: {"content": {ATOM: {"schema": TEXT}}}, **errors()}, response_class=Response)
def read_flags_feed(request: Request, store: Reading) -> Response:
    """The latest changes of flags and verdicts, newest first, as Atom."""
    content = atom_feed(store.notices.latest(MOST_ENTRIES), str(request.url), str(request.base_url))
    return Response(content, media_type=ATOM)


@router.get("/due.ics", responses={200: {"content": {CALENDAR: {"schema": TEXT}}}, **errors()}, response_class=Response)
def read_due_dates(request: Request, store: Reading, now: Now) -> Response:
    """The days on which calibrations are due, as a calendar: of the first 1,000 units, overdue ones before all."""
    days = [
        DueDay(
            unit=one.unit,
            day=one.at.date(),
            summary=f"{one.unit}: calibration {'overdue' if one.at < now else 'due'}",
            description=one.reason,
            url=f"{request.base_url}units/{quote(one.unit)}",
        )
        for one in store.outlooks.due(MOST_DAYS)
    ]
    return Response(calendar(days, now), media_type=f"{CALENDAR}; charset=utf-8")
