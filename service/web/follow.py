"""A page whose diagnosis is still being made follows by itself, ever more slowly, also without scripts."""

from datetime import datetime

SOONEST, LATEST = 2, 60
"""Seconds: a usual diagnosis takes one or two; behind many others it takes minutes."""


def follow_seconds(uploaded_at: datetime, now: datetime, workers: int) -> int | None:
    """After how long a page looks again: half of what it has taken so far. None where nobody makes it unasked."""
    if not workers:
        return None
    return round(min(max((now - uploaded_at).total_seconds() / 2, SOONEST), LATEST))
