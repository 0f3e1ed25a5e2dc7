"""iCalendar (RFC 5545): one whole-day event a unit, on the day its calibration is due."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from datetime import UTC, date, datetime, timedelta
from uuid import NAMESPACE_URL, uuid5

LONGEST_LINE = 75
"""Octets, without the line's end."""
ESCAPES = str.maketrans({"\\": "\\\\", ";": "\\;", ",": "\\,", "\n": "\\n", "\r": None})
HEAD = (
    "BEGIN:VCALENDAR", "VERSION:2.0", "PRODID:-//imu-health//due dates//EN", "CALSCALE:GREGORIAN", "METHOD:PUBLISH",
    "X-WR-CALNAME:Calibrations due",
)  # fmt: skip


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
    lines = [*HEAD, *(line for day in days for line in _event(day, now)), "END:VCALENDAR"]
    return b"".join(_folded(line) + b"\r\n" for line in lines)


def _event(due: DueDay, now: datetime) -> Iterator[str]:
    yield "BEGIN:VEVENT"
    yield f"UID:{uuid5(NAMESPACE_URL, f'imu-health/due/{due.unit}')}@imu-health"
    yield f"DTSTAMP:{now.astimezone(UTC):%Y%m%dT%H%M%SZ}"
    yield f"DTSTART;VALUE=DATE:{due.day:%Y%m%d}"
    yield f"DTEND;VALUE=DATE:{due.day + timedelta(days=1):%Y%m%d}"
    yield f"SUMMARY:{_text(due.summary)}"
    yield f"DESCRIPTION:{_text(due.description)}"
    yield f"URL:{due.url}"
    yield "TRANSP:TRANSPARENT"
    yield "END:VEVENT"


def _text(value: str) -> str:
    """Escaped; control characters, which a calendar cannot hold, are left out."""
    return "".join(c for c in value if c >= " " or c == "\n").replace("\x7f", "").translate(ESCAPES)


def _folded(line: str) -> bytes:
    """Broken where it grows too long, never inside a character: what follows begins with a space."""
    parts, part = [], b""
    for character in line:
        octets = character.encode()
        if len(part) + len(octets) > LONGEST_LINE:
            parts.append(part)
            part = b" "
        part += octets
    return b"\r\n".join([*parts, part])
