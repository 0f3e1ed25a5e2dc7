"""How long tests wait. What a test waits for comes, or it never comes: how fast the machine is decides nothing."""

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
    """What a look gives as soon as it gives something."""
    end, pause = monotonic() + LONG, Event()
    while not (found := look()):
        assert monotonic() < end, "it never came"
        pause.wait(PAUSE)
    return found
