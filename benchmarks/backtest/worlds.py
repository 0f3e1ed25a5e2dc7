"""The generators that everything is asked of, and what each calls its kinds."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.backtest import histories, workshop
from benchmarks.backtest.histories import History, Plan
from benchmarks.backtest.knowing import Law
from benchmarks.backtest.laws import FIRST_LAW, SECOND_LAW
from estimator.session import Array

FLEET = 20
"""Units of a type."""


@dataclass(frozen=True)
class World:
    """A generator."""

    described: Mapping[str, str]
    """Description of every kind; nothing moves in the first."""
    late: str
    """Kind of a drift that begins some day."""
    plan: Plan
    """Plan of histories in which changes are looked for; a change may show in the last session alone."""
    long: Plan
    """Plan of long histories in which changes are looked for."""
    sessions: Mapping[str, tuple[int, int]]
    """Fewest and most, of units whose due date is looked at."""
    dates: Callable[[Plan, np.random.Generator], Array]
    history: Callable[[str, Array, Plan, np.random.Generator], History]
    law: Law
    """The generator's laws, for somebody who knows them."""

    @property
    def kinds(self) -> tuple[str, ...]:
        """All."""
        return tuple(self.described)

    @property
    def still(self) -> str:
        """The kind in which nothing moves."""
        return self.kinds[0]

    @property
    def fleet(self) -> tuple[str, ...]:
        """The units of a type: of some, one parameter does something."""
        return (*[self.still] * (FLEET + 1 - len(self.kinds)), *self.kinds[1:])

    def planned(self, sessions: tuple[int, int], since: int = 0) -> Plan:
        """Measured so often, with changes so many sessions back or more."""
        return replace(self.plan, sessions=sessions, since=since)

    def made(self, kind: str, plan: Plan, rng: np.random.Generator) -> History:
        """One history with dates of its own."""
        return self.history(kind, self.dates(plan, rng), plan, rng)


FIRST = World(
    histories.DESCRIBED,
    "late ramp",
    Plan(since=1),
    Plan(sessions=(17, 60), since=1),
    {"2 to 3": (2, 3), "4 to 5": (4, 5), "6 to 7": (6, 7), "8 to 16": (8, 16)},
    histories.dates,
    histories.history,
    FIRST_LAW,
)
SECOND = World(
    workshop.DESCRIBED,
    "late creep",
    Plan(sessions=(4, 16), sigma=(0.01, 0.25), since=1, freedom=workshop.TAILS),
    Plan(sessions=(17, 60), sigma=(0.01, 0.25), since=1, freedom=workshop.TAILS),
    {"3": (3, 3), "4 to 7": (4, 7), "8 to 20": (8, 20), "21 to 60": (21, 60)},
    workshop.dates,
    workshop.history,
    SECOND_LAW,
)
