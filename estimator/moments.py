"""Moments as session files state them: ISO 8601 with an offset from UTC. Everything inside is UTC."""

from datetime import UTC, datetime


def moment(stated: str) -> datetime:
    """What a text states, in UTC; without an offset it is UTC.

    Raises
    ------
    ValueError : it is no date and time.
    OverflowError : in UTC it lies before the year 1 or after 9999.
    """
    at = datetime.fromisoformat(stated)
    return (at if at.tzinfo else at.replace(tzinfo=UTC)).astimezone(UTC)


def written(at: datetime) -> str:
    """``2026-03-01T09:00:00Z``, with a fraction of a second where there is one; ``at`` with an offset."""
    return f"{at.astimezone(UTC).replace(tzinfo=None).isoformat()}Z"


def in_utc(stated: str | None) -> str | None:
    """The same moment in UTC; None where nothing is stated, which earlier versions also wrote as an empty text."""
    return written(moment(stated)) if stated else None
