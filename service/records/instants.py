"""Moments as numbers."""

from datetime import UTC, datetime, timedelta

EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
MILLISECOND = timedelta(milliseconds=1)


def epoch_ms(moment: datetime) -> int:
    """Whole milliseconds since the start of 1970, UTC, as dashboards and browsers count."""
    return (moment - EPOCH) // MILLISECOND
