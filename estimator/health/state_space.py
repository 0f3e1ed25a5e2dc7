"""The model of a drifting deviation: exact likelihood and levels, at every strength of the walk.

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
"""

from dataclasses import dataclass

import numpy as np

from estimator.session import Array

WALKS = np.geomspace(0.01, 2.0, 8)
"""(8,) √q of the nodes, T a root year."""
PRIOR = np.exp(-0.5 * (np.log(WALKS / 0.2) / 1.5) ** 2)
"""(8,) of the nodes, not normalised, dimensionless: log-normal about 0.2 T a root year."""
RATE = 0.5
"""ρ, T a year: what keeps its tolerance between calibrations drifts no faster."""
DIFFUSE = 10.0
"""One sigma of a level, and of a step, before it is measured, T: wide against all that a unit in use shows."""


@dataclass(frozen=True, eq=False)
class Padded:
    """B series of n sessions at most; where a series is shorter, its last session is repeated and not read."""

    time: Array
    """(B, n) years."""
    value: Array
    """(B, n) deviation, in tolerances."""
    variance: Array
    """(B, n) of each reading, in tolerances squared."""
    there: Array
    """(B, n) bool; False where padded."""

    @property
    def gap(self) -> Array:
        """(B, n) number of years since the session before; 0 for the first."""
        return np.diff(self.time, axis=1, prepend=self.time[:, :1])


@dataclass(frozen=True, eq=False)
class Filtered:
    """One forward pass over n sessions; tolerances and years."""

    log_likelihood: Array
    """(B, Q)"""
    error: list[Array]
    """n times (B, Q): reading less prediction."""
    precision: list[Array]
    """n times (B, Q): 1/S; 0 where there is no reading."""
    predicted: list[tuple[Array, ...]]
    """n times l, r, P_ll, P_lr, P_rr before each reading, each (B, Q)."""
    final: tuple[Array, ...]
    """The same after the last reading."""


def filtered(data: Padded, steps: Array) -> Filtered:
    """Level and rate forward through the sessions, at every node, relative to the tolerance.

    steps : (B, n) bool; where the level may jump.
    """
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
    return Filtered(likelihood, errors, precisions, predicted, (level, r, p00, p01, p11))


def scores(data: Padded, done: Filtered) -> list[tuple[Array, ...]]:
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


def weights(log_likelihood: Array) -> Array:
    """(B, Q) relative weight of the nodes: likelihood × prior, from log likelihoods (B, Q) without unit."""
    weight = PRIOR * np.exp(log_likelihood - log_likelihood.max(axis=1, keepdims=True))
    return weight / weight.sum(axis=1, keepdims=True)


def smoothed(predicted: tuple[Array, ...], score: tuple[Array, ...], weight: Array) -> tuple[Array, Array]:
    """(B,) level and (B,) its sigma at one session, in tolerances, all sessions considered.

    Parameters
    ----------
    predicted, score : of the session, from `filtered` and `scores`; each part (B, Q).
    weight : (B, Q) of the nodes, dimensionless.
    """
    level, _, p00, p01, _ = predicted
    x0, x1, n00, n01, n11 = score
    mean = level + p00 * x0 + p01 * x1
    variance = p00 - (p00**2 * n00 + 2 * p00 * p01 * n01 + p01**2 * n11)
    return moments(mean, np.maximum(variance, 0.0), weight)


def moments(mean: Array, variance: Array, weight: Array) -> tuple[Array, Array]:
    """(B,) mean and (B,) sigma of a mixture, from (B, Q) means and variances and relative weights (B, Q)."""
    middle = (weight * mean).sum(axis=1)
    return middle, np.sqrt((weight * (variance + (mean - middle[:, None]) ** 2)).sum(axis=1))
