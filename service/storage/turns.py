"""Who writes next, within one process: in the order in which they came."""

from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Lock

from service.errors import AwayError
from service.storage.faults import AWAY


class Turns:
    """One at a time; nobody overtakes."""

    def __init__(self, patience: float) -> None:
        self._patience = patience
        """Seconds without anybody's turn ending after which one that waits gives up: a long line is no fault."""
        self._own, self._line, self._ended = Lock(), deque[Lock](), 0

    @contextmanager
    def taken(self) -> Iterator[None]:
        """A turn; AwayError where whoever has it takes too long."""
        place, ended = self._come(), self._ended
        try:
            while not place.acquire(timeout=self._patience):
                if self._ended == ended:
                    raise AwayError(AWAY)
                ended = self._ended
            yield
        finally:
            self._leave(place)

    def _come(self) -> Lock:
        """The last place in the line; the first one is open."""
        place = Lock()
        with self._own:
            if self._line:
                place.acquire()
            self._line.append(place)
        return place

    def _leave(self, place: Lock) -> None:
        """Opens the place of the next, where it was the first that left."""
        with self._own:
            was_first = self._line[0] is place
            self._line.remove(place)
            self._ended += was_first
            if was_first and self._line:
                self._line[0].release()

    def __len__(self) -> int:
        """Who has the turn, and who waits."""
        return len(self._line)
