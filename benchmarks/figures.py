"""What a benchmark returns, and how it is timed."""

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Figure:
    """One row of the table: our time, the peer's, and the ratio that is aimed at."""

    id: str
    work: str
    peer: str
    ours: float
    """s"""
    theirs: float
    """s"""
    target: str

    @property
    def ratio(self) -> float:
        """How many times faster than the peer."""
        return self.theirs / self.ours


def side_by_side(
    ours: Callable[[], object],
    theirs: Callable[[], object],
    rounds: int,
    clock: Callable[[], float] = time.process_time,
) -> tuple[float, float]:
    """Median processor seconds of each, in turn: other programs do not add to them. One round is not measured."""
    ours(), theirs()
    taken: tuple[list[float], list[float]] = ([], [])
    for _ in range(rounds):
        for work, times in zip((ours, theirs), taken, strict=True):
            began = clock()
            work()
            times.append(clock() - began)
    return statistics.median(taken[0]), statistics.median(taken[1])
