"""When a parameter reaches its tolerance, and the risk of waiting. Time in years from the last session.

The level of `trend` goes on from what the sessions left of it: l + r·t + √q·B(t), (l, r) normal at every node of q.
It reaches the tolerance when |level| first is T. Given l, the rate is still normal, N(μ, κ²), and with it in the drift
the first passage of a distance a has a closed form (Whitmore 1986, from the inverse Gaussian):

    P(t) = Φ((μt − a)/√(qt + κ²t²)) + exp(2μa/q + 2κ²a²/q²)·Φ(−(a + μt + 2κ²at/q)/√(qt + κ²t²))

taken for both sides and summed (a walk that passes both is counted twice: the chance is never stated too low), averaged
over l by Gauss–Hermite quadrature and over the nodes of q. Parameters of a unit move on their own, so the chance that
none of them is out is the product.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize.elementwise import find_root
from scipy.special import log_ndtr, ndtr

from estimator.health.state_space import WALKS
from estimator.health.trend import Trends
from estimator.session import Array

AHEAD = np.concatenate([[0.0], np.geomspace(0.02, 12.0, 30)])
"""(31,) years at which the chance is worked out; between them it is interpolated. Twelve years outlast any interval."""
NODES, WEIGHTS = np.polynomial.hermite_e.hermegauss(7)
"""(7,) of the level, in sigmas, and their weights, dimensionless: exact for polynomials of degree 13."""
MEDIAN, EARLY = 0.5, 0.1
"""Chances whose dates are stated: as likely as not, and the 90 % bound."""
RISK_LEVEL = 0.05
"""Chance of a unit being out of tolerance that its next calibration must come before."""


def passage(found: Trends, ahead: Array = AHEAD) -> Array:
    """Probability that each series has reached its tolerance.

    Parameters
    ----------
    found : B trends.
    ahead : (h,) years after the last session, increasing.

    Returns
    -------
    chance : (B, h) probability, never falling.
    """
    p00, p01, p11 = (found.covariance[..., i, None] for i in range(3))
    level = found.mean[..., :1] + np.sqrt(np.maximum(p00, 0.0)) * NODES
    slope = np.divide(p01, p00, out=np.zeros_like(p01), where=p00 > 0)
    rate = found.mean[..., 1:] + slope * (level - found.mean[..., :1])
    free = np.maximum(p11 - slope * p01, 0.0)
    q = WALKS[:, None, None] ** 2
    t = np.maximum(ahead, 1e-9)
    sides = [_first_passage(1 - side * level[..., None], side * rate[..., None], free[..., None], q, t)
             for side in (1.0, -1.0)]  # fmt: skip
    given = np.minimum(sides[0] + sides[1], 1.0)
    chance = np.einsum("bqlh,l,bq->bh", given, WEIGHTS / WEIGHTS.sum(), found.weight)
    return np.maximum.accumulate(np.clip(chance, 0.0, 1.0), axis=1)


def _first_passage(distance: Array, rate: Array, free: Array, q: Array, t: Array) -> Array:
    """(B, Q, l, h) probability of the closed form; 1 where the tolerance is reached already.

    Parameters
    ----------
    distance : (B, Q, l, 1) a, tolerances.
    rate, free : (B, Q, l, 1) μ, tolerances a year, and (B, Q, 1, 1) κ², tolerances squared a year squared.
    q, t : (Q, 1, 1) tolerances squared a year, and (h,) years.
    """
    spread = np.sqrt(q * t + free * t**2)
    ahead = np.maximum(distance, 0.0)
    beyond = ndtr((rate * t - ahead) / spread)
    exponent = 2 * rate * ahead / q + 2 * free * ahead**2 / q**2
    back = exponent + log_ndtr(-(ahead + rate * t + 2 * free * ahead * t / q) / spread)
    return np.where(distance <= 0, 1.0, np.minimum(beyond + np.exp(np.minimum(back, 0.0)), 1.0))


def reach(chance: Array, level: float, ahead: Array = AHEAD) -> Array:
    """When the chance of having reached the tolerance passes a level.

    Parameters
    ----------
    chance : (B, h) probability, never falling.
    level : the probability asked for.
    ahead : (h,) years at which the chances hold.

    Returns
    -------
    (B,) years; infinite beyond the last of ``ahead``.
    """
    return np.array([np.interp(level, row, ahead, right=np.inf) for row in chance])


def together(chance: Array) -> Array:
    """(h,) probability that any of B parameters, each with a probability (B, h), has reached its tolerance."""
    return np.asarray(-np.expm1(np.log1p(-np.minimum(chance, 1 - 1e-15)).sum(axis=0)))


@dataclass(frozen=True, eq=False)
class Band:
    """Quantiles of the level at times ahead, in tolerances."""

    ahead: Array
    """(B, h) years."""
    quantiles: Array
    """(B, k, h) tolerances."""


def band(found: Trends, ahead: Array, levels: tuple[float, ...]) -> Band:
    """Quantiles of the mixture.

    Parameters
    ----------
    found : B trends, relative to their tolerances.
    ahead : (B, h) years after the last session.
    levels : k probabilities, such as 0.05, 0.25, 0.5, 0.75, 0.95.
    """
    mean, variance = found.at(ahead)
    sigma = np.sqrt(variance + 1e-18)
    series, level, date = np.ogrid[: len(mean), : len(levels), : mean.shape[2]]

    def excess(x: Array, i: Array, p: Array, h: Array) -> Array:
        """Share of the mixture below levels x (n,), tolerances, less the probability p (n,); i, h (n,) places."""
        below = ndtr((x[..., None] - mean[i, :, h]) / sigma[i, :, h])
        return np.asarray((below * found.weight[i]).sum(axis=-1) - p)

    wanted = np.array(levels)[level]
    edges = ((mean - 12 * sigma).min(axis=1), (mean + 12 * sigma).max(axis=1))
    roots = find_root(excess, tuple(edge[:, None] for edge in edges), args=(series, wanted, date))
    return Band(ahead, np.asarray(roots.x))


def predictive(found: Trends, ahead: Array, value: Array, sigma: Array) -> Array:
    """Probability of a later reading below a value.

    Parameters
    ----------
    found : B trends.
    ahead : (B, h) years after the last session.
    value, sigma : (B, h) tolerances; each value with its own standard uncertainty.

    Returns
    -------
    (B, h) probability.
    """
    mean, variance = found.at(ahead)
    spread = np.sqrt(variance + sigma[:, None] ** 2)
    return np.asarray(np.einsum("bqh,bq->bh", ndtr((value[:, None] - mean) / spread), found.weight))
