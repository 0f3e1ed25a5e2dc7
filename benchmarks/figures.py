"""Results of a benchmark, and its timing."""

import os
import resource
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from fractions import Fraction

IMPORTS = (sys.executable, "-c", "import numpy, scipy")
"""The program whose time is *m*."""
ROUNDS = 5
"""Times that it is run for one figure."""
COMPILING = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
"""Programs are started from compiled files, as an installation has them."""


def shown(value: float, unit: str) -> str:
    """The value with its unit; seconds below one as milliseconds."""
    if unit == "s" and value < 1:
        return f"{1e3 * value:.3g} ms"
    return f"{value:.3g} {unit}".rstrip()


def start(*command: str) -> None:
    """Runs a command to its end."""
    subprocess.run(command, env=COMPILING, stdout=subprocess.DEVNULL, check=True)


def children() -> float:
    """Processor seconds of all processes that were started here and have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def importing(clock: Callable[[], float] = time.monotonic) -> float:
    """m at this moment, s: machines differ by a factor of three, and one by what else it does."""
    taken = []
    for _ in range(ROUNDS):
        began = clock()
        start(*IMPORTS)
        taken.append(clock() - began)
    return statistics.median(taken)


@dataclass(frozen=True)
class Felt:
    """One row of what a user feels: seconds beside m, or another measure."""

    id: str
    what: str
    value: float
    """s, or in ``unit``."""
    most: float | None
    """Largest value aimed at, in ``unit``; None where there is no target."""
    unit: str = "m"
    """Unit of the target."""
    m: float = field(default_factory=importing)
    """s, of the same moment and by the same clock: `importing` with `children` beside processor seconds."""

    def row(self) -> str:
        """One line of the table."""
        is_time = self.unit in ("m", "s")
        compared = self.value / self.m if self.unit == "m" else self.value
        target = "—" if self.most is None else f"≤ {self.most:g} {self.unit}".rstrip()
        reached = "—" if self.most is None else "yes" if compared <= self.most else "no"
        in_m = f"{self.value / self.m:.3g} m" if is_time else "—"
        value = shown(self.value, "s" if is_time else self.unit)
        return f"| {self.id} | {self.what} | {value} | {in_m} | {target} | {reached} |"


@dataclass(frozen=True)
class Figure:
    """One row of the table: ours, the peer's or the limit, and the ratio that is aimed at."""

    id: str
    work: str
    peer: str
    ours: float
    """s, or in ``unit``."""
    theirs: float
    """The peer's figure, or the most that ours may be; same unit."""
    target: str
    """The least ratio: a number or a fraction, words before it; — where nothing is aimed at."""
    unit: str = "s"

    @property
    def ratio(self) -> float:
        """The peer's figure over ours: how many times faster, or smaller, ours is."""
        return self.theirs / self.ours

    @property
    def reached(self) -> str:
        """Whether the ratio reaches its target, in words."""
        if self.target == "—":
            return "—"
        return "yes" if self.ratio >= Fraction(self.target.split()[-1]) else "no"

    def row(self) -> str:
        """One line of the table."""
        ours, theirs = shown(self.ours, self.unit), shown(self.theirs, self.unit)
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
