"""Moments as numbers, and moments that people give, in UTC."""

from datetime import UTC, datetime, timedelta

EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
MILLISECOND = timedelta(milliseconds=1)
EARLIEST, LATEST = datetime(1900, 1, 1, tzinfo=UTC), datetime(2200, 1, 1, tzinfo=UTC)
"""Between which everything is kept."""


def epoch_ms(moment: datetime) -> int:
    """Whole milliseconds since the start of 1970, UTC, as dashboards and browsers count."""
    return (moment - EPOCH) // MILLISECOND


def aware(moment: datetime) -> datetime:
    """Without an offset it is UTC."""
    return moment if moment.tzinfo else moment.replace(tzinfo=UTC)


def in_utc(moment: datetime) -> datetime:
    """The same moment in UTC; ValueError of one that is not kept."""
    known = aware(moment)
    if not EARLIEST <= known < LATEST:
        raise ValueError("must lie between 1900 and 2200")
    return known.astimezone(UTC)
