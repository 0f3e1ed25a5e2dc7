"""Whole units of a type, as their outlook is made: histories of several parameters, one prior for all."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.backtest.histories import History, Plan
from benchmarks.backtest.worlds import World
from estimator.health.pooled import Prior, learn
from estimator.health.prognosis import Prognosis, Track, evidence, prognosis
from estimator.session import Array

PARAMETERS = 6
"""Parameters of a unit: the biases of six sensors."""
NOW = np.zeros(1)
"""No fan is looked at."""


@dataclass(frozen=True, eq=False)
class Unit:
    """One unit; its first parameter does what its kind says, the others are stable."""

    kind: str
    parameters: tuple[History, ...]

    @property
    def passed(self) -> float:
        """Years from the last session until any parameter is out of tolerance."""
        return min(one.passed for one in self.parameters)


def unit(world: World, kind: str, plan: Plan, rng: np.random.Generator) -> Unit:
    """Measured once for all its parameters."""
    time = world.dates(plan, rng)
    kinds = (kind, *[world.still] * (PARAMETERS - 1))
    return Unit(kind, tuple(world.history(one, time, plan, rng) for one in kinds))


def track(one: History) -> Track:
    """The track that the outlook is made from."""
    return Track(one.time, one.value[:, None], one.sigma[:, None], 1.0, temperature=one.temperature)


def learned(units: Sequence[Unit]) -> Prior:
    """The prior learned from all parameters of all units."""
    return learn([evidence(track(one)) for unit in units for one in unit.parameters])


def outlook(one: Unit, prior: Prior, ahead: Array = NOW) -> Prognosis:
    """The outlook of one unit."""
    return prognosis([track(p) for p in one.parameters], [prior] * len(one.parameters), ahead)
