"""Times at which the samples of a recording were taken, some of which may be missing or left out."""

from typing import overload

import numpy as np

from estimator.session import Array

EVERY = 0.25
"""s between the samples whose moments are kept: far finer than a fault is dated."""


class Taken:
    """Keeps the moments of the samples that are used, in memory of some numbers a second.

    rate : Hz; None of averages, which are counted by their rows.
    """

    def __init__(self, rate: float | None) -> None:
        self._rate = rate or 1.0
        self._used = self._rows = 0
        self._begin: float | None = None
        self._nominal, self._moment = [np.zeros(1)], [np.zeros(1)]

    def add(self, used: Array, time: Array | None) -> None:
        """The next rows, ``used`` (R,) bool or not, and their ``time`` (R,) s; None where they follow at the rate."""
        at = (self._rows + np.arange(len(used))) / self._rate
        if time is not None and len(time) and np.ptp(time) > 0:
            self._begin = float(time[0]) if self._begin is None else self._begin
            at = time - self._begin
        at = at[used]
        kept = np.arange(0, len(at), max(round(EVERY * self._rate), 1))
        self._nominal.append((self._used + kept) / self._rate)
        self._moment.append(at[kept])
        self._rows, self._used = self._rows + len(used), self._used + len(at)

    @overload
    def at(self, nominal: float) -> float: ...
    @overload
    def at(self, nominal: Array) -> Array: ...
    def at(self, nominal: float | Array) -> float | Array:
        """The moment, s since the start, of what would be at ``nominal``, s, if no sample were missing before it."""
        known, moment = np.concatenate(self._nominal), np.concatenate(self._moment)
        found = np.interp(nominal, known, moment) + np.maximum(np.asarray(nominal) - known[-1], 0.0)
        return float(found) if np.ndim(nominal) == 0 else np.asarray(found)
