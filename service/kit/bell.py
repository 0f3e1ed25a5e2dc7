"""Wakes the makers of diagnoses when new ones are to be made, and those who wait for a diagnosis when it is there."""

from threading import Condition


class Bell:
    """Signal between the threads of one process; the work of other processes is found by polling."""

    def __init__(self) -> None:
        self._condition, self._rung = Condition(), 0

    @property
    def rung(self) -> int:
        """Number of rings so far: read it before looking for work, so that nothing is missed between look and wait."""
        return self._rung

    def ring(self) -> None:
        """Wakes everybody."""
        with self._condition:
            self._rung += 1
            self._condition.notify_all()

    def wait(self, rung: int, seconds: float) -> None:
        """Waits until it rang once more, or the time is over."""
        with self._condition:
            self._condition.wait_for(lambda: self._rung != rung, seconds)
