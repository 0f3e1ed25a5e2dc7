"""Sessions of the demonstration that are stored beside the first requests, before any other work on them."""

from collections.abc import Callable
from threading import Event

from estimator.message import say


class StoppedError(Exception):
    """The service stops while sessions are still to be stored."""


class Filling:
    """Progress of the storing. Its one thread writes, the pages read."""

    def __init__(self, store: Callable[[Callable[[], None]], None], total: int) -> None:
        """Takes ``store``, which stores ``total`` sessions and calls its argument after each."""
        self._store, self._total = store, total
        self._done, self._is_over = 0, False

    def run(self, stop: Event) -> None:
        """Stores sessions until all are stored, or the service stops."""

        def advance() -> None:
            self._done += 1
            if stop.is_set():
                raise StoppedError

        try:
            self._store(advance)
        except StoppedError:
            pass
        finally:
            self._is_over = True

    @property
    def is_over(self) -> bool:
        """Whether it has ended."""
        return self._is_over

    @property
    def in_words(self) -> str:
        """Progress in words; empty at its end."""
        if self._is_over:
            return ""
        return say(
            "A simulated demonstration fleet is being stored: {done} of {total} sessions.",
            done=self._done,
            total=self._total,
        )
