"""Drift: level, rate and steps of a parameter's deviation from its reference, from sessions at irregular dates.

The model is that of `state_space`.

Rate: its p-value is Σ_q w_q·2Φ(−|r_q|/s_q), the chance of a rate of the other sign, doubled.

Steps: the score of a step at gap k given q is (x, N) of the backward recursion, its squared t-statistic x²/N; weights
of the nodes as if the step were there, so that it does not pass for a walk; p_k = Σ_q w_qk·2Φ(−|t_qk|). The least of
the n − 1 p-values is Šidák-corrected (look-elsewhere); below the level the step is taken in and the search repeated.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr

from estimator.health.state_space import DIFFUSE, WALKS, Padded, filtered, moments, scores, smoothed, weights
from estimator.session import Array

MOST_STEPS = 3
"""Found in one series; what jumps more often walks."""
FEWEST = 4
"""Sessions, the reference included, that a step can be looked for in: level, rate and step fit any three."""
STEP_LEVEL = 0.01
"""Chance of a step being found in a series that has none."""


@dataclass(frozen=True, eq=False)
class Series:
    """One deviation through time, in order."""

    time: Array
    """(n,) years."""
    value: Array
    """(n,) deviation from the recorded reference; any unit."""
    sigma: Array
    """(n,) standard uncertainty of each."""
    tolerance: float
    """T, in the unit of the value."""


@dataclass(frozen=True, eq=False)
class Trends:
    """What B series say, in tolerances and years; Q nodes of the walk."""

    time: Array
    """(B, n) years; padded with the last."""
    there: Array
    """(B, n) False where padded."""
    level: Array
    """(B, n) the deviation at each session, all sessions considered, in tolerances."""
    level_sigma: Array
    """(B, n) one sigma of it, in tolerances."""
    rate: Array
    """(B,) tolerances a year."""
    rate_sigma: Array
    """(B,) one sigma of it, tolerances a year."""
    p_value: Array
    """(B,) of the rate: the chance of one at least this far from zero when there is none."""
    steps: Array
    """(B, n) True where a step was found between the session before and this one."""
    step_p: Array
    """(B, n) p-value of a step that was found, corrected for the choice of its place; NaN elsewhere."""
    weight: Array
    """(B, Q) of the nodes, summing to one."""
    mean: Array
    """(B, Q, 2) level and rate at the last session, in tolerances, a year."""
    covariance: Array
    """(B, Q, 3) of level, of level and rate, of rate, in tolerances squared, a year, a year squared."""

    @property
    def last(self) -> Array:
        """(B,) date of the last session, years relative to each series' own zero."""
        return self.time[:, -1]

    def at(self, ahead: Array) -> tuple[Array, Array]:
        """Mean and variance of the level relative to the tolerance, node by node, after the last session.

        Parameters
        ----------
        ahead : (B, h) years after the last session, not negative.

        Returns
        -------
        mean : (B, Q, h) tolerances.
        variance : (B, Q, h) tolerances squared.
        """
        h, (level, rate) = ahead[:, None, :], (self.mean[..., :1], self.mean[..., 1:])
        p00, p01, p11 = (self.covariance[..., i : i + 1] for i in range(3))
        walked = WALKS[:, None] ** 2 * h
        return level + rate * h, np.maximum(p00 + 2 * h * p01 + h**2 * p11 + walked, 0.0)


def trends(series: Sequence[Series], step_level: float = STEP_LEVEL) -> Trends:
    """Trend of every series; ``step_level`` is the chance of a step being found in a series that has none."""
    data = padded(series)
    steps = np.zeros(data.there.shape, dtype=bool)
    step_p = np.full(data.there.shape, np.nan)
    searching = data.there.sum(axis=1) >= FEWEST
    for _ in range(MOST_STEPS):
        if not searching.any():
            break
        rows = np.flatnonzero(searching)
        place, p = _best_step(Padded(*(part[rows] for part in vars(data).values())), steps[rows])
        found = p < step_level
        steps[rows[found], place[found]], step_p[rows[found], place[found]] = True, p[found]
        searching[rows[~found]] = False
    return _mixed(data, steps, step_p)


def sudden(series: Sequence[Series]) -> Array:
    """(B,) probability of so evident a step in each series by chance, corrected for the choice of its place."""
    data = padded(series)
    return _best_step(data, np.zeros(data.there.shape, dtype=bool))[1]


def padded(series: Sequence[Series]) -> Padded:
    """Series of any lengths in one table, in tolerances."""
    n = max(len(s.time) for s in series)

    def column(values: list[Array]) -> Array:
        """(B, n) from B columns (n_b,) of any unit, each continued by its last number."""
        return np.stack([np.concatenate([v, np.full(n - len(v), v[-1])]) for v in values])

    time = column([np.asarray(s.time, dtype=float) for s in series])
    value = column([np.asarray(s.value, dtype=float) / s.tolerance for s in series])
    variance = column([(np.asarray(s.sigma, dtype=float) / s.tolerance) ** 2 for s in series])
    there = np.stack([np.arange(n) < len(s.time) for s in series])
    return Padded(time, value, np.maximum(variance, 1e-12), there)


def _best_step(data: Padded, steps: Array) -> tuple[Array, Array]:
    """(B,) number of the most evident gap, and (B,) its p-value; ``steps`` (B, n) bool are known already."""
    done = filtered(data, steps)
    p = np.ones(data.time.shape)
    for k, (x, _, n, _, _) in enumerate(scores(data, done)):
        gain = np.where(n > 0, x**2 / (n + DIFFUSE**-2), 0.0)
        weight = weights(done.log_likelihood + 0.5 * gain - 0.5 * np.log1p(np.maximum(n, 0) * DIFFUSE**2))
        t = np.sqrt(np.divide(x**2, n, out=np.zeros_like(x), where=n > 0))
        p[:, k] = (weight * 2 * ndtr(-t)).sum(axis=1)
    p[~data.there | steps] = 1.0
    p[:, 0] = 1.0
    place, gaps = p.argmin(axis=1), np.maximum(data.there.sum(axis=1) - 1, 1)
    return place, -np.expm1(gaps * np.log1p(-np.minimum(p.min(axis=1), 1 - 1e-12)))


def _mixed(data: Padded, steps: Array, step_p: Array) -> Trends:
    """Everything as the mixture over the nodes; ``steps`` (B, n) bool, their probability by chance (B, n)."""
    done = filtered(data, steps)
    weight = weights(done.log_likelihood)
    levels = [smoothed(p, s, weight) for p, s in zip(done.predicted, scores(data, done), strict=True)]
    level, r, p00, p01, p11 = done.final
    rate, rate_sigma = moments(r, p11, weight)
    return Trends(
        time=data.time,
        there=data.there,
        level=np.stack([mean for mean, _ in levels], axis=1),
        level_sigma=np.stack([sigma for _, sigma in levels], axis=1),
        rate=rate,
        rate_sigma=rate_sigma,
        p_value=(weight * 2 * ndtr(-np.abs(r) / np.sqrt(p11))).sum(axis=1),
        steps=steps,
        step_p=step_p,
        weight=weight,
        mean=np.stack([level, r], axis=-1),
        covariance=np.stack([p00, p01, p11], axis=-1),
    )
