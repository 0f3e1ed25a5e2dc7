"""iCalendar (RFC 5545): one whole-day event a unit, on the day its calibration is due."""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from datetime import date, datetime, timedelta
from uuid import NAMESPACE_URL, uuid5

from icalendar import Calendar, Event, vText

ABOUT = {
    "VERSION": "2.0",
    "PRODID": "-//imu-health//due dates//EN",
    "CALSCALE": "GREGORIAN",
    "METHOD": "PUBLISH",
    "X-WR-CALNAME": "Calibrations due",
}
"""Of the calendar."""
NOT_TEXT = re.compile("[\x00-\x09\x0b-\x1f\x7f]")
"""Characters that no text of a calendar can hold (section 3.1, CONTROL), and tabs."""


@dataclass(frozen=True)
class DueDay:
    """One event."""

    unit: str
    day: date
    summary: str
    description: str
    url: str


class _Text(vText):
    """A text in which a backslash before N stays one: the library, at 7.3, takes the two for a new line."""

    def to_ical(self) -> bytes:
        return rb"\\N".join(vText(part).to_ical() for part in self.split(r"\N"))


def calendar(days: Iterable[DueDay], now: datetime) -> bytes:
    """The calendar; an event's identifier is that of its unit, so that a new date moves the event."""
    found = Calendar()
    for name, value in ABOUT.items():
        found.add(name, value)
    for day in days:
        found.add_component(_event(day, now))
    written: bytes = found.to_ical(sorted=False)
    return written


def _event(due: DueDay, now: datetime) -> Event:
    event = Event()
    event.add("UID", f"{uuid5(NAMESPACE_URL, f'imu-health/due/{due.unit}')}@imu-health")
    event.add("DTSTAMP", now)
    event.add("DTSTART", due.day)
    event.add("DTEND", due.day + timedelta(days=1))
    event.add("SUMMARY", _text(due.summary))
    event.add("DESCRIPTION", _text(due.description))
    event.add("URL", due.url)
    event.add("TRANSP", "TRANSPARENT")
    return event


def _text(value: str) -> _Text:
    return _Text(NOT_TEXT.sub("", value))
