"""What a benchmark returns, and how it is timed."""

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction


@dataclass(frozen=True)
class Figure:
    """One row of the table: ours, the peer's or the limit, and the ratio that is aimed at."""

    id: str
    work: str
    peer: str
    ours: float
    """s, or in ``unit``."""
    theirs: float
    """The same of the peer, or what ours may be at most."""
    target: str
    """The least ratio: a number or a fraction, words before it; — where nothing is aimed at."""
    unit: str = "s"

    @property
    def ratio(self) -> float:
        """How many times faster, or smaller, than the peer."""
        return self.theirs / self.ours

    @property
    def reached(self) -> str:
        """Whether the ratio is what was aimed at."""
        if self.target == "—":
            return "—"
        return "yes" if self.ratio >= Fraction(self.target.split()[-1]) else "no"

    def shown(self, value: float) -> str:
        """With its unit; seconds below one as milliseconds."""
        if self.unit == "s" and value < 1:
            return f"{1e3 * value:.3g} ms"
        return f"{value:.3g} {self.unit}".rstrip()

    def row(self) -> str:
        """One line of the table."""
        ours, theirs = self.shown(self.ours), self.shown(self.theirs)
        return (
            f"| {self.id} | {self.work} | {ours} | {self.peer} | {theirs} "
            f"| {self.ratio:.3g} | {self.target} | {self.reached} |"
        )


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
