"""What each sensor did by itself, averaged over who else may have moved.

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

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from estimator.health.changes import Changes
from estimator.health.deviation import Deviation
from estimator.health.moved import FEWEST_AGREEING, Fit, fit, is_majority
from estimator.session import Array

ODDS = 0.1
"""That a sensor changed between two sessions by more than they see: one in ten."""
SIGMAS = 10.0
"""κ in standard errors where no tolerance says what matters; a drift that is wanted found is of that order."""
LEAST = 1e-4
"""Weight below which a set changes no figure."""

Sensors = frozenset[int]


@dataclass(frozen=True, eq=False)
class Sets:
    """Changes, with the scatter that x is taken with, and what a free sensor costs."""

    changes: Changes
    """With the scatter that a majority agrees within."""
    weighing: Changes
    """With the scatter that x is taken with."""
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


def residuals(sets: Sets, out: Iterable[int]) -> dict[str, Deviation]:
    """By sensor; ``out`` the sensors that tests found to have moved."""
    fits: dict[Sensors, tuple[Fit, Fit]] = {}
    names = sets.changes.names
    return {name: _averaged(sets, j, frozenset(out), fits) for j, name in enumerate(names)}


def _averaged(sets: Sets, j: int, out: Sensors, fits: dict[Sensors, tuple[Fit, Fit]]) -> Deviation:
    """The mixture for one sensor."""
    chosen = list(dict.fromkeys(_near(sets, j, out - {j})))
    inside = [_inside(sets, j, moved) for moved in chosen]
    for one in {*inside, *(sets.everyone() - moved for moved in chosen)} - fits.keys():
        fits[one] = fit(sets.changes, sorted(one)), fit(sets.weighing, sorted(one))
    logs = np.array([_weight(sets, j, *pair, fits) for pair in zip(chosen, inside, strict=True)])
    weights = np.exp(logs - logs.max())
    weights /= weights.sum()
    told = [(w, _beside(sets, j, fits[one][1].gain)) for w, one in zip(weights, inside, strict=True) if w > LEAST]
    return _mixture(told)


def _weight(sets: Sets, j: int, moved: Sensors, inside: Sensors, fits: Mapping[Sensors, tuple[Fit, Fit]]) -> float:
    """log w_M, up to a constant; x rests on the sensors ``inside``."""
    rest = sets.everyone() - moved
    stays, goes = -fits[rest][0].chi2 / 2, sets.cost(j) - fits[inside][0].chi2 / 2
    return sum(map(sets.cost, moved)) + (stays if inside == rest else float(np.logaddexp(stays, goes)))


def _near(sets: Sets, j: int, out: Sensors) -> Iterator[Sensors]:
    """The set that was found, and those that differ by one sensor more, less or exchanged; a majority remains."""
    others = sets.everyone() - out - {j}
    for less, more in product([None, *sorted(out)], [None, *sorted(others)]):
        moved = (out - {less}) | ({more} - {None})
        found = frozenset(i for i in moved if i is not None)
        if is_majority(sets.changes, list(found)):
            yield found


def _inside(sets: Sets, j: int, moved: Sensors) -> Sensors:
    """Whom x rests on; without the sensor itself unless the others are too few."""
    others = sets.everyone() - moved - {j}
    return others if len(others) >= FEWEST_AGREEING[sets.changes.rows] else others | {j}


def _beside(sets: Sets, j: int, gain: Array) -> Deviation:
    """What x = gain·y leaves of the sensor; gain (k, m r) dimensionless. What the others do on their own is a part of
    its uncertainty, what it does itself is not."""
    changes, at = sets.changes, sets.changes.where([j])
    drag = changes.design[at] @ gain
    rest = -drag
    rest[:, at] += np.eye(changes.rows)
    others = np.delete(drag, at, axis=1)
    own = rest @ changes.own @ rest.T + changes.scatter**2 * others @ others.T
    dofs = changes.dofs[j] if changes.dofs else (None, None)
    return Deviation(rest @ changes.y, own, rest @ changes.origin @ rest.T, *dofs)


def _mixture(told: list[tuple[float, Deviation]]) -> Deviation:
    """One deviation with the mixture's mean and covariance; what the sets differ by is this session's."""
    total = sum(w for w, _ in told)
    shares = [(w / total, d) for w, d in told]
    mean = sum((w * d.vector for w, d in shares), np.zeros_like(told[0][1].vector))
    own, origin = np.zeros_like(told[0][1].own), np.zeros_like(told[0][1].own)
    for w, d in shares:
        away = d.vector - mean
        own, origin = own + w * (d.own + np.outer(away, away)), origin + w * d.origin
    return replace(told[0][1], vector=mean, own=own, origin=origin)
