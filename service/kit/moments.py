"""Moments as numbers, and moments that people give, in UTC."""

from datetime import UTC, datetime, timedelta, timezone

EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
MILLISECOND = timedelta(milliseconds=1)
EARLIEST, LATEST = datetime(1900, 1, 1, tzinfo=UTC), datetime(2200, 1, 1, tzinfo=UTC)
"""Bounds of all stored times."""


def epoch_ms(moment: datetime) -> int:
    """Whole milliseconds since the start of 1970, UTC, as dashboards and browsers count."""
    return (moment - EPOCH) // MILLISECOND


def aware(moment: datetime) -> datetime:
    """The moment with an offset: UTC where it has none."""
    return moment if moment.tzinfo else moment.replace(tzinfo=UTC)


def offset_minutes(at: datetime) -> int | None:
    """The moment's offset from UTC, minutes; None where it is UTC or unknown."""
    offset = at.utcoffset()
    return (offset // timedelta(minutes=1) or None) if offset else None


def local(at: datetime, offset: int | None) -> datetime:
    """The moment by the clock of the place: a day in Auckland is the one that its files and papers state."""
    return at if offset is None else at.astimezone(timezone(timedelta(minutes=offset)))


def in_utc(moment: datetime) -> datetime:
    """The moment in UTC; ValueError outside the years that are kept."""
    known = aware(moment)
    if not EARLIEST <= known < LATEST:
        raise ValueError("must lie between 1900 and 2200")
    return known.astimezone(UTC)
