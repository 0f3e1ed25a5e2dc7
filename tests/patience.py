"""Waiting in tests. An awaited event comes, or it never comes: the speed of the machine decides nothing."""

from collections.abc import Callable
from threading import Event
from time import monotonic
from typing import TypeVar

LONG = 600.0
"""Seconds after which what is waited for is taken as lost: a hundred times what it takes on a machine that is free."""
PAUSE = 0.05
"""Seconds between two looks at what another process does."""
Found = TypeVar("Found")


def until(look: Callable[[], Found | None]) -> Found:
    """Looks until there is a result, and returns it."""
    end, pause = monotonic() + LONG, Event()
    while not (found := look()):
        assert monotonic() < end, "it never came"
        pause.wait(PAUSE)
    return found
