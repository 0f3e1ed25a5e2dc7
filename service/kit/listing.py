"""What every list is asked for, beside what narrows it."""

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class ListQuery:
    """Which part of a list is wanted, and from which end on."""

    backwards: bool = False
    after: str | int | None = None
    """The entry that the list goes on after; one that is not there begins the list anew."""
    before: str | int | None = None
    """The entry that it ends before."""
    offset: int = 0
    """How many are left out first, where a page has a number instead of a place."""
    limit: int = 100
