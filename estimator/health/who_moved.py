"""Each sensor's own change, averaged over the sets of other sensors that may have moved.

A sensor that moved and takes part in the common change x drags it, and its own residual shows only a part 1 − h of what
it did, h its leverage. Taking it out once a test finds it does not help the one that the test just misses: sensors that
drifted by a few sigmas would be stated too small. Every sensor is therefore judged by its deleted residual (Cook and
Weisberg 1982, 2.2), the change beside an x that it has no part in, whatever it did:

    s_j = y_j − A_j·x_M,    x_M = gain_M·y from the sensors but j and those of a set M that moved too

Which others moved is open where several sets M explain the rest nearly as well. Each has the posterior weight

    w_M ∝ (exp(−χ²_M/2) + c_j·exp(−χ²_{M∪j}/2))·Π_{i∈M} c_i,    c_i = o·√det(Σ_i)/κʳ

χ²_M of all sensors but those of M; o the odds that a sensor moved; the rest of c what a sensor that is free costs: its
change is known to Σ_i where beforehand it could have been anything of the order of κ, in each of its r rows. The sensor
itself may have stayed or moved, and pays for it as the others do. With one of four axes free the other three hold x
together, the judged one among them: there is no second term, and were it for nothing in the other sets, a drift of
another axis would pass for its own. The mixture of the normal laws of s_j under every M has

    mean  Σ w_M·s_M,    covariance  Σ w_M·(Σ_M + (s_M − mean)(s_M − mean)ᵀ)

Looked at are the sets within one addition, one removal or one exchange of the set that the tests found. A sensor stays
in x itself where the others would be too few. Units as in `changes`.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np

from estimator.health.changes import Changes
from estimator.health.deviation import Deviation
from estimator.health.moved import FEWEST_AGREEING, fits, is_majority
from estimator.session import Array

ODDS = 0.1
"""Odds that a sensor changed between two sessions by more than they can see: one in ten."""
SIGMAS = 10.0
"""κ in standard errors where no tolerance says what matters; a drift that is wanted found is of that order."""
LEAST = 1e-4
"""Weight below which a set changes no figure."""

Sensors = frozenset[int]


@dataclass(frozen=True, eq=False)
class Sets:
    """Changes, with the scatter that x is taken with, and what a free sensor costs."""

    changes: Changes
    """Changes, with the scatter within which a majority agrees."""
    weighing: Changes
    """Changes, with the scatter that x is taken with."""
    reach: float
    """κ, rad or relative; 0 where no tolerance says it."""

    def everyone(self) -> Sensors:
        """All sensors, by number."""
        return frozenset(range(len(self.changes.names)))

    def cost(self, sensor: int) -> float:
        """Logarithm of the weight of a sensor that is free."""
        at = self.changes.where([sensor])
        sigma2 = float(np.linalg.det(self.changes.covariance[np.ix_(at, at)])) ** (1 / self.changes.rows)
        sigma = float(np.sqrt(sigma2))
        reach = max(self.reach or SIGMAS * sigma, sigma)
        return float(np.log(ODDS) + self.changes.rows * np.log(sigma / reach))


@dataclass(frozen=True, eq=False)
class Tried:
    """Every sensor beside every set that may have moved: n pairs."""

    judged: list[int]
    """(n,) number of the sensor, rising."""
    moved: list[Sensors]
    inside: list[Sensors]
    """The sensors that x rests on."""


def residuals(sets: Sets, excluded: Iterable[int]) -> dict[str, Deviation]:
    """The residual of each sensor, by name; ``excluded``: the sensors that the tests found to have moved."""
    tried, changes = _tried(sets, frozenset(excluded)), sets.changes
    likely = _weights(sets, tried)
    vectors, current, origin = _residuals_of(sets, tried)
    mean = likely @ vectors
    away = vectors - mean[tried.judged]
    current = np.tensordot(likely, current + away[:, :, None] * away[:, None, :], axes=1)
    origin = np.tensordot(likely, origin, axes=1)
    dofs = changes.dofs or ((None, None),) * len(changes.names)
    return {name: Deviation(mean[j], current[j], origin[j], *dofs[j]) for j, name in enumerate(changes.names)}


def _tried(sets: Sets, excluded: Sensors) -> Tried:
    """All pairs; a sensor's own sets are others for each."""
    numbers = range(len(sets.changes.names))
    pairs = [(j, moved) for j in numbers for moved in dict.fromkeys(_near(sets, j, excluded - {j}))]
    return Tried([j for j, _ in pairs], [moved for _, moved in pairs], [_inside(sets, *pair) for pair in pairs])


def _weights(sets: Sets, tried: Tried) -> Array:
    """(m, n) w_M of every sensor's sets, each row of sum 1, dimensionless; 0 for other sensors' and negligible ones."""
    rests = [sets.everyone() - moved for moved in tried.moved]
    every = list({*tried.inside, *rests})
    chi2 = dict(zip(every, fits(sets.changes, [sorted(members) for members in every]).chi2, strict=True))
    costs = [sets.cost(i) for i in range(len(sets.changes.names))]
    stays = np.array([-chi2[rest] / 2 for rest in rests])
    goes = np.array([costs[j] - chi2[inside] / 2 for j, inside in zip(tried.judged, tried.inside, strict=True)])
    held = [inside == rest for inside, rest in zip(tried.inside, rests, strict=True)]
    paid = [sum(costs[i] for i in moved) for moved in tried.moved]
    logs = np.full((len(costs), len(rests)), -np.inf)
    logs[tried.judged, np.arange(len(rests))] = paid + np.where(held, stays, np.logaddexp(stays, goes))
    weights = np.exp(logs - logs.max(axis=1, keepdims=True))
    weights /= weights.sum(axis=1, keepdims=True)
    weights[weights <= LEAST] = 0.0
    return weights / weights.sum(axis=1, keepdims=True)


def _near(sets: Sets, j: int, excluded: Sensors) -> Iterator[Sensors]:
    """The set that was found, and those that differ by one sensor more, less or exchanged; a majority remains."""
    others = sets.everyone() - excluded - {j}
    for less, more in product([None, *sorted(excluded)], [None, *sorted(others)]):
        moved = (excluded - {less}) | ({more} - {None})
        candidate = frozenset(i for i in moved if i is not None)
        if is_majority(sets.changes, list(candidate)):
            yield candidate


def _inside(sets: Sets, j: int, moved: Sensors) -> Sensors:
    """The sensors that x rests on; without the sensor itself unless the others are too few."""
    others = sets.everyone() - moved - {j}
    return others if len(others) >= FEWEST_AGREEING[sets.changes.rows] else others | {j}


def _residuals_of(sets: Sets, tried: Tried) -> tuple[Array, Array, Array]:
    """The residual (n, r) of the sensor of every pair beside x, and its covariances (n, r, r) from both sessions; rad
    or relative. The wander of the other sensors is a part of its uncertainty, the sensor's own is not.
    """
    changes, every = sets.changes, list(dict.fromkeys(tried.inside))
    fitted = fits(sets.weighing, [sorted(members) for members in every])
    numbers, rows = np.arange(len(tried.judged)), changes.rows
    at = np.array(tried.judged)[:, None] * rows + np.arange(rows)
    drag = changes.design[at] @ fitted.gain[[every.index(members) for members in tried.inside]]
    rest = -drag
    rest[numbers[:, None], np.arange(rows), at] += 1.0
    drag[numbers[:, None], :, at] = 0.0
    across = np.swapaxes(rest, -1, -2)
    others = drag @ np.swapaxes(drag, -1, -2)
    current = rest @ changes.current @ across + changes.scatter**2 * others
    return rest @ changes.y, current, rest @ changes.origin @ across
