"""Wakes those who make diagnoses when there are new ones to be made, and those who wait for one when it is there."""

from collections import deque
from threading import Condition


class Bell:
    """Of one process; what other processes do is found by looking now and then."""

    def __init__(self) -> None:
        self._condition, self._rung = Condition(), 0
        self._urgent: deque[str] = deque()

    @property
    def rung(self) -> int:
        """How often it rang so far: taken before one looks, so that nothing is missed between look and wait."""
        return self._rung

    def ring(self) -> None:
        """Wakes everybody."""
        with self._condition:
            self._rung += 1
            self._condition.notify_all()

    def wait(self, rung: int, seconds: float) -> None:
        """Until it rang once more, or the time is over."""
        with self._condition:
            self._condition.wait_for(lambda: self._rung != rung, seconds)

    def hurry(self, session: str) -> None:
        """Somebody waits for the diagnosis of a session: it comes before the others."""
        if session not in self._urgent:
            self._urgent.append(session)
            self.ring()

    def urgent(self) -> str | None:
        """The session that somebody has waited for the longest."""
        try:
            return self._urgent.popleft()
        except IndexError:
            return None
