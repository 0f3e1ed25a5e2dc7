"""How far a long file was read: told by the process that reads it, heard by whoever waits for it.

A log is gone through more than once: for its labels or its rests first, then for its averages.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from threading import Lock
from time import monotonic

PAUSE = 1.0
"""Seconds between two words of it: a page looks again every two."""

Heard = Callable[[int, int], None]
"""Is told how many bytes were read of the file, after how many times through all of it; ends the reading by raising."""

_listener: ContextVar[Heard | None] = ContextVar("listener", default=None)


@contextmanager
def heard_by(listener: Heard) -> Iterator[None]:
    """Around the reading of a file: who hears how far it is."""
    token = _listener.set(listener)
    try:
        yield
    finally:
        _listener.reset(token)


def listener() -> Heard | None:
    """Who hears it."""
    return _listener.get()


class Teller:
    """Of the process that reads; parts may be read in a thread of their own."""

    def __init__(self, tell: Heard | None = None) -> None:
        self._tell, self._lock = tell, Lock()
        self._times, self._last = 0, 0.0

    def at(self, done: int, total: int) -> None:
        """So many bytes of all are read this time."""
        if self._tell is None:
            return
        with self._lock:
            now = monotonic()
            if self._tell is not None and now - self._last >= PAUSE:
                self._last = now
                self._tell(done, self._times)
            self._times += done >= total

    def silence(self) -> None:
        """The answer follows: nothing is told any more."""
        with self._lock:
            self._tell = None


class _InForce:
    """The one of this process."""

    teller = Teller()


def teller() -> Teller:
    """Of this process."""
    return _InForce.teller


def use(teller: Teller) -> None:
    """Sets it for this process."""
    _InForce.teller = teller
