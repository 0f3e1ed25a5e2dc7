"""The part of a list that a request asks for, besides its filters."""

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class ListQuery:
    """Part of a list, and the end from which it is read."""

    backwards: bool = False
    after: str | int | None = None
    """The entry after which the list goes on; one that is not there begins the list anew."""
    before: str | int | None = None
    """The entry before which it ends."""
    offset: int = 0
    """Number of entries left out first, where a page has a number instead of a place."""
    limit: int = 100
