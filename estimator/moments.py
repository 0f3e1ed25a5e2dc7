"""Moments as session files state them: ISO 8601 with an offset from UTC. Everything inside is UTC, but for the start of
a session, which keeps its offset: the day in the place where it was measured."""

from datetime import UTC, datetime
from math import ceil

from estimator.message import say, say_count


def moment(stated: str) -> datetime:
    """Reads a moment into UTC; without an offset it is UTC.

    Raises
    ------
    ValueError : it is no date and time.
    OverflowError : in UTC it lies before the year 1 or after 9999.
    """
    return local_moment(stated).astimezone(UTC)


def local_moment(stated: str) -> datetime:
    """The moment with the offset that is stated, or else in UTC; ValueError where it is no date and time."""
    at = datetime.fromisoformat(stated)
    return at if at.tzinfo else at.replace(tzinfo=UTC)


def as_stated(at: datetime) -> str:
    """``2026-03-02T08:30:00+13:00``, and Z where the offset is none; ``at`` with an offset."""
    return at.isoformat() if at.utcoffset() else written(at)


def written(at: datetime) -> str:
    """``2026-03-01T09:00:00Z``, with a fraction of a second where there is one; ``at`` with an offset."""
    return f"{at.astimezone(UTC).replace(tzinfo=None).isoformat()}Z"


def in_utc(stated: str | None) -> str | None:
    """The moment in UTC; None where nothing is stated, which earlier versions also wrote as an empty text."""
    return written(moment(stated)) if stated else None


MINUTE, HOUR, DAY = 60.0, 3600.0, 86_400.0
"""s."""


def duration(seconds: float) -> str:
    """``39 seconds``, ``35 min``, ``5 h 10 min``, ``3 days``: rounded up."""
    minutes = ceil(seconds / MINUTE)
    if seconds < 2 * MINUTE:
        return say_count("{n} second", "{n} seconds", ceil(seconds))
    if seconds < 2 * HOUR:
        return say("{minutes} min", minutes=minutes)
    if seconds < 2 * DAY:
        hours, rest = divmod(minutes, 60)
        return say("{hours} h {rest} min", hours=hours, rest=rest)
    return say_count("{n} day", "{n} days", ceil(seconds / DAY))
