"""Drift: level, rate and steps of a parameter's deviation from its reference, from sessions at irregular dates.

State space, one series (Durbin & Koopman 2012, ch. 2–4), time in years, deviation in tolerances T:

    z_k     = l_k + e_k,                     e_k ~ N(0, σ_k²), σ_k known of every session
    l_{k+1} = l_k + r·Δt_k + w_k + s_k,      w_k ~ N(0, q·Δt_k), s_k a step, zero but where one was found
    r       constant,                        r ~ N(0, ρ²)

z is the deviation from the reference values *as they were recorded*; the reference session itself is the reading
0 ± its own uncertainty at its date. The likelihood is exact: prediction errors of the Kalman filter; what all sessions
say of any date follows from the backward recursion of the scores (de Jong & Penzer 1998).

The walk q is unknown, and few sessions say little of it. Nothing is computed at one best q: the likelihood is taken at
the nodes of a grid of √q and every answer is the mixture over the nodes, weighted by likelihood × prior. That carries
the ignorance of q into every bound, as Student's t does for an unknown variance. Prior: √q log-normal about 0.2 T a
root year (95 % within a factor of nineteen), ρ = 0.5 T a year: what keeps its tolerance between calibrations at all.

Rate: its p-value is Σ_q w_q·2Φ(−|r_q|/s_q), the chance of a rate of the other sign, doubled.

Steps: the score of a step at gap k given q is (x, N) of the backward recursion, its squared t-statistic x²/N; weights
of the nodes as if the step were there, so that it does not pass for a walk; p_k = Σ_q w_qk·2Φ(−|t_qk|). The least of
the n − 1 p-values is Šidák-corrected (look-elsewhere); below the level the step is taken in and the search repeated.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr

from estimator.session import Array

WALKS = np.geomspace(0.01, 2.0, 8)
"""√q of the nodes, T a root year."""
PRIOR = np.exp(-0.5 * (np.log(WALKS / 0.2) / 1.5) ** 2)
RATE = 0.5
"""ρ, T a year."""
DIFFUSE = 10.0
"""One sigma of a level, and of a step, before it is measured, T."""
MOST_STEPS = 3
FEWEST = 4
"""Sessions, the reference included, that a step can be looked for in."""
STEP_LEVEL = 0.01


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
    """(B, n) the deviation at each session, all sessions considered."""
    level_sigma: Array
    """(B, n)"""
    rate: Array
    """(B,) a year."""
    rate_sigma: Array
    """(B,)"""
    p_value: Array
    """(B,) of the rate: the chance of one at least this far from zero when there is none."""
    steps: Array
    """(B, n) True where a step was found between the session before and this one."""
    step_p: Array
    """(B, n) p-value of a step that was found, corrected for the choice of its place; NaN elsewhere."""
    weight: Array
    """(B, Q) of the nodes."""
    mean: Array
    """(B, Q, 2) level and rate at the last session."""
    covariance: Array
    """(B, Q, 3) of level, of level and rate, of rate."""

    @property
    def last(self) -> Array:
        """(B,) date of the last session, years."""
        return self.time[:, -1]

    def at(self, ahead: Array) -> tuple[Array, Array]:
        """Mean and variance of the level, node by node, at times ahead of the last session.

        Parameters
        ----------
        ahead : (B, h) years, not negative.

        Returns
        -------
        two (B, Q, h)
        """
        h, (level, rate) = ahead[:, None, :], (self.mean[..., :1], self.mean[..., 1:])
        p00, p01, p11 = (self.covariance[..., i : i + 1] for i in range(3))
        walked = WALKS[:, None] ** 2 * h
        return level + rate * h, np.maximum(p00 + 2 * h * p01 + h**2 * p11 + walked, 0.0)


@dataclass(frozen=True, eq=False)
class _Data:
    """Padded series: (B, n)."""

    time: Array
    value: Array
    variance: Array
    there: Array

    @property
    def gap(self) -> Array:
        """(B, n) years since the session before; 0 for the first."""
        return np.diff(self.time, axis=1, prepend=self.time[:, :1])


@dataclass(frozen=True, eq=False)
class _Filtered:
    """One forward pass; (B, Q) a session."""

    log_likelihood: Array
    error: list[Array]
    precision: list[Array]
    """1/S; 0 where there is no reading."""
    predicted: list[tuple[Array, ...]]
    """l, r, P_ll, P_lr, P_rr before each reading."""
    final: tuple[Array, ...]


def trends(series: Sequence[Series], step_level: float = STEP_LEVEL) -> Trends:
    """Trend of every series; ``step_level`` is the chance of a step being found in a series that has none."""
    data = _padded(series)
    steps = np.zeros(data.there.shape, dtype=bool)
    step_p = np.full(data.there.shape, np.nan)
    searching = data.there.sum(axis=1) >= FEWEST
    for _ in range(MOST_STEPS):
        if not searching.any():
            break
        rows = np.flatnonzero(searching)
        place, p = _best_step(_Data(*(part[rows] for part in vars(data).values())), steps[rows])
        found = p < step_level
        steps[rows[found], place[found]], step_p[rows[found], place[found]] = True, p[found]
        searching[rows[~found]] = False
    return _mixed(data, steps, step_p)


def sudden(series: Sequence[Series]) -> Array:
    """(B,) p-value of the most evident step of each series, corrected for the choice of its place."""
    data = _padded(series)
    return _best_step(data, np.zeros(data.there.shape, dtype=bool))[1]


def _padded(series: Sequence[Series]) -> _Data:
    n = max(len(s.time) for s in series)

    def column(values: list[Array]) -> Array:
        return np.stack([np.concatenate([v, np.full(n - len(v), v[-1])]) for v in values])

    time = column([np.asarray(s.time, dtype=float) for s in series])
    value = column([np.asarray(s.value, dtype=float) / s.tolerance for s in series])
    variance = column([(np.asarray(s.sigma, dtype=float) / s.tolerance) ** 2 for s in series])
    there = np.stack([np.arange(n) < len(s.time) for s in series])
    return _Data(time, value, np.maximum(variance, 1e-12), there)


def _filter(data: _Data, steps: Array) -> _Filtered:
    """Level and rate forward through the sessions, at every node."""
    size = (len(data.time), len(WALKS))
    level, r = np.zeros(size), np.zeros(size)
    p00, p01, p11 = np.full(size, DIFFUSE**2), np.zeros(size), np.full(size, RATE**2)
    likelihood = np.zeros(size)
    errors, precisions, predicted = list[Array](), list[Array](), list[tuple[Array, ...]]()
    for k in range(data.time.shape[1]):
        dt = data.gap[:, k, None]
        level, p00, p01 = level + r * dt, p00 + dt * (2 * p01 + dt * p11), p01 + dt * p11
        p00 = p00 + WALKS**2 * dt + DIFFUSE**2 * steps[:, k, None]
        predicted.append((level, r, p00, p01, p11))
        error = data.value[:, k, None] - level
        precision = data.there[:, k, None] / (p00 + data.variance[:, k, None])
        likelihood = likelihood - 0.5 * (precision * error**2 - np.log(np.where(precision > 0, precision, 1.0)))
        level, r = level + p00 * precision * error, r + p01 * precision * error
        p00, p01, p11 = p00 - p00**2 * precision, p01 - p00 * p01 * precision, p11 - p01**2 * precision
        errors.append(error)
        precisions.append(precision)
    return _Filtered(likelihood, errors, precisions, predicted, (level, r, p00, p01, p11))


def _scores(data: _Data, done: _Filtered) -> list[tuple[Array, ...]]:
    """Backward: gradient (x_l, x_r) and information (N_ll, N_lr, N_rr) of the predicted state at each session."""
    zero = np.zeros_like(done.log_likelihood)
    x0, x1, n00, n01, n11 = zero, zero, zero, zero, zero
    found: list[tuple[Array, ...]] = []
    for k in reversed(range(data.time.shape[1])):
        _, _, p00, p01, _ = done.predicted[k]
        precision, error = done.precision[k], done.error[k]
        k0, k1 = p00 * precision, p01 * precision
        own = precision * error - (k0 * x0 + k1 * x1)
        inner = k0 * n00 + k1 * n01
        cross = k0 * n01 + k1 * n11
        n00, n01 = n00 + precision - 2 * inner + k0 * inner + k1 * cross, n01 - cross
        x0 = x0 + own
        found.append((x0, x1, n00, n01, n11))
        dt = data.gap[:, k, None]
        x1, n11, n01 = x1 + dt * x0, n11 + dt * (2 * n01 + dt * n00), n01 + dt * n00
    return found[::-1]


def _best_step(data: _Data, steps: Array) -> tuple[Array, Array]:
    """(B,) the most evident gap and its corrected p-value."""
    done = _filter(data, steps)
    p = np.ones(data.time.shape)
    for k, (x, _, n, _, _) in enumerate(_scores(data, done)):
        gain = np.where(n > 0, x**2 / (n + DIFFUSE**-2), 0.0)
        weight = _weights(done.log_likelihood + 0.5 * gain - 0.5 * np.log1p(np.maximum(n, 0) * DIFFUSE**2))
        t = np.sqrt(np.divide(x**2, n, out=np.zeros_like(x), where=n > 0))
        p[:, k] = (weight * 2 * ndtr(-t)).sum(axis=1)
    p[~data.there | steps] = 1.0
    p[:, 0] = 1.0
    place, gaps = p.argmin(axis=1), np.maximum(data.there.sum(axis=1) - 1, 1)
    return place, -np.expm1(gaps * np.log1p(-np.minimum(p.min(axis=1), 1 - 1e-12)))


def _weights(log_likelihood: Array) -> Array:
    """(B, Q) of the nodes: likelihood × prior, summing to one."""
    weight = PRIOR * np.exp(log_likelihood - log_likelihood.max(axis=1, keepdims=True))
    return weight / weight.sum(axis=1, keepdims=True)


def _mixed(data: _Data, steps: Array, step_p: Array) -> Trends:
    """Everything as the mixture over the nodes."""
    done = _filter(data, steps)
    weight = _weights(done.log_likelihood)
    smoothed = [_smoothed(p, s, weight) for p, s in zip(done.predicted, _scores(data, done), strict=True)]
    level, r, p00, p01, p11 = done.final
    rate, rate_sigma = _moments(r, p11, weight)
    return Trends(
        time=data.time,
        there=data.there,
        level=np.stack([mean for mean, _ in smoothed], axis=1),
        level_sigma=np.stack([sigma for _, sigma in smoothed], axis=1),
        rate=rate,
        rate_sigma=rate_sigma,
        p_value=(weight * 2 * ndtr(-np.abs(r) / np.sqrt(p11))).sum(axis=1),
        steps=steps,
        step_p=step_p,
        weight=weight,
        mean=np.stack([level, r], axis=-1),
        covariance=np.stack([p00, p01, p11], axis=-1),
    )


def _smoothed(predicted: tuple[Array, ...], score: tuple[Array, ...], weight: Array) -> tuple[Array, Array]:
    """(B,) level and its sigma at one session, all sessions considered."""
    level, _, p00, p01, _ = predicted
    x0, x1, n00, n01, n11 = score
    mean = level + p00 * x0 + p01 * x1
    variance = p00 - (p00**2 * n00 + 2 * p00 * p01 * n01 + p01**2 * n11)
    return _moments(mean, np.maximum(variance, 0.0), weight)


def _moments(mean: Array, variance: Array, weight: Array) -> tuple[Array, Array]:
    """(B,) mean and sigma of a mixture."""
    middle = (weight * mean).sum(axis=1)
    return middle, np.sqrt((weight * (variance + (mean - middle[:, None]) ** 2)).sum(axis=1))
