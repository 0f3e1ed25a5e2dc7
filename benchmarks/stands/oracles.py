"""Oracles that know how blocks are seated, for the same fleets; they share nothing with the estimator.

With τ known, V_u = diag(τ² + σ²) is that of a unit's sessions and P_u = V⁻¹ − V⁻¹11ᵀV⁻¹/1ᵀV⁻¹1 takes its mean off.
A stand that turned by δ at a date, column d, gives b = dᵀPz ~ N(J·δ, J·1), J = dᵀPd.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from benchmarks.stands.fleets import ARCSEC, SIGMA, TURNED
from estimator.health.stand_events import FEWEST_UNITS
from estimator.health.stands import StandMotion

LEVEL = 0.01
"""Chance of naming a stand where nothing moved, that of the estimator."""
DRAWS, PAIRED = 1000, 200
"""Draws of fleets in which nothing moved, of the same schedule; so many that the limit is right to three in a thousand,
and to seven where all pairs of dates are looked at.
"""
Vectors = NDArray[np.float64]
Seating = Callable[[int, int], float]


def knows_all_but_the_stand(motions: list[StandMotion], seating: Seating, turn: tuple[float, float]) -> bool:
    """Whether the first stand is named by one who knows date (years), direction and size (arcsec) of the ``turn``."""
    since, size = turn
    stands, times, centred, value = _whole(motions, seating)
    columns = np.stack([(stands == s) & (times >= since) for s in np.unique(stands)]).astype(float)
    delta = size * ARCSEC * TURNED
    pull, information = columns @ centred @ value @ delta, np.einsum("dn,nm,dm->d", columns, centred, columns)
    gain = pull - information * (delta @ delta) / 2
    return bool(gain.argmax() == 0 and gain[0] > np.log(len(gain) / LEVEL))


def knows_the_seating(motions: list[StandMotion], seating: Seating, rng: np.random.Generator) -> bool:
    """Whether the first stand is named by one who knows τ alone: the largest χ² of three over all dates of all stands,
    at its own level on this schedule.
    """
    stands, times, centred, value = _whole(motions, seating)
    columns = np.concatenate([(stands == s) & (times >= t) for s in np.unique(stands)
                              for t in times[stands == s, None, None]]).astype(float)  # fmt: skip
    information = np.einsum("dn,nm,dm->d", columns, centred, columns)
    tells = information > 1e-6 * information.max()
    weight, owner = columns[tells] @ centred, np.repeat(np.unique(stands), np.unique(stands, return_counts=True)[1])
    chi2 = ((weight @ value) ** 2).sum(axis=1) / information[tells]
    deviations = np.sqrt(_variance(motions, seating))
    still = deviations[:, None] * rng.standard_normal((len(motions), 3 * DRAWS))
    null = ((weight @ still).reshape(len(weight), DRAWS, 3) ** 2).sum(axis=2) / information[tells, None]
    return bool(owner[tells][chi2.argmax()] == 0 and chi2.max() > np.quantile(null.max(axis=0), 1 - LEVEL))


def knows_the_scatter(
    motions: list[StandMotion], seating: Seating, rng: np.random.Generator
) -> tuple[float, float] | None:
    """The dates between which the first stand was turned, years, by one who knows τ alone: the largest χ² of three over
    all pairs of dates of all stands with three units on either side, at its own level on this schedule; None where it
    is another stand's, or within the level.
    """
    stands, times, centred, value = _whole(motions, seating)
    units = np.array([m.unit for m in motions])
    still = np.sqrt(_variance(motions, seating))[:, None] * rng.standard_normal((len(motions), 3 * PAIRED))
    best, null = (0.0, -1.0, 0.0, 0.0), np.zeros(PAIRED)
    for stand in np.unique(stands):
        dates = np.append(np.sort(times[stands == stand]), np.inf)
        columns = ((stands == stand) & (times >= dates[:, None])).astype(float)
        told = columns @ (units[:, None] == np.unique(units))
        shared, weight = columns @ centred @ columns.T, columns @ centred
        pull, chance = weight @ value, (weight @ still).reshape(len(dates), PAIRED, 3)
        for i in range(len(dates) - 1):
            information = shared[i, i] + shared.diagonal()[i + 1 :] - 2 * shared[i, i + 1 :]
            j = i + 1 + np.flatnonzero(((told[i] > told[i + 1 :]).sum(axis=1) >= FEWEST_UNITS) & (information > 0))
            if not len(j):
                continue
            chi2 = ((pull[i] - pull[j]) ** 2).sum(axis=1) / information[j - i - 1]
            null = np.maximum(
                null, (((chance[i] - chance[j]) ** 2).sum(axis=2) / information[j - i - 1, None]).max(axis=0)
            )
            best = max(best, (float(chi2.max()), float(stand), float(dates[i]), float(dates[j[chi2.argmax()]])))
    return best[2:] if best[1] == 0 and best[0] > np.quantile(null, 1 - LEVEL) else None


def _variance(motions: list[StandMotion], seating: Seating) -> Vectors:
    """(n,) rad², of every session by itself."""
    scale = np.array([seating(int(m.unit[1:]), int(m.stand[1:])) for m in motions])
    return (scale * ARCSEC) ** 2 + SIGMA**2


def _whole(motions: list[StandMotion], seating: Seating) -> tuple[Vectors, Vectors, Vectors, Vectors]:
    """(n,) stands, (n,) dates, (n, n) P of all units together, (n, 3) readings."""
    units = np.array([m.unit for m in motions])
    precision = 1 / _variance(motions, seating)
    same = (units[:, None] == units).astype(float)
    centred = np.diag(precision) - same * np.outer(precision, precision) / (same @ precision)[:, None]
    stands = np.array([float(m.stand[1:]) for m in motions])
    return stands, np.array([m.time for m in motions]), centred, np.array([m.value for m in motions])
