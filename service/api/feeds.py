"""Due dates as a calendar that people's own tools subscribe to."""

from urllib.parse import quote

from fastapi import APIRouter, Request, Response

from service.api.calendar import DueDay, calendar
from service.api.schemas.problem import errors
from service.dependencies import Now, Reading

router = APIRouter(prefix="/feeds", tags=["feeds"])
CALENDAR = "text/calendar"
"""Media type (RFC 5545 section 8.1)."""
MOST_DAYS = 1000
"""Units in the calendar, the first that are due: years of work, and little to fetch every hour."""
TEXT = {"type": "string"}
"""What the description says of the answer."""


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
