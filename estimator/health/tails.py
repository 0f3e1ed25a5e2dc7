"""Heaviness of the tails of errors: Student's law of ν degrees of freedom with the stated standard deviation.

One bad mounting in fifty looks like a jump to whoever takes all errors to be normal. How heavy tails are is a matter of
the unit type and its workshop, and is learned from all its histories (`pooled`). Of each history under each ν,

    L_ν = w_0·M(0, n) + w_1·Σ_k share_k·M(0, k)·M(k, n)/κ + w_2·L_∞,    M(i, j) = ∫ Π_{i ≤ m < j} t_ν((z_m − μ)/σ_m) dμ

nothing, one jump of any size, or anything else, whose likelihood L_∞ is that of `fits` for normal errors, the same for
every ν: a history that drifts or walks says nothing of tails. κ is the span of sizes.
"""

import numpy as np

from estimator.health.error_laws import FREEDOMS, log_density
from estimator.health.fits import Readings
from estimator.health.shapes import Kind, Shapes
from estimator.session import Array

NOTHING, JUMP, ELSE = 0.7, 0.1, 0.2
"""Shares of what a history may be."""
SIZES = 2.0
"""κ, T: jumps from one side of the tolerance to the other."""
FINEST, COARSEST = 1024, 96
"""Nodes of μ."""
MARGIN = 5.0
"""Sigmas beyond the readings that μ may be."""


def log_tails(readings: Readings, family: Shapes, evidence: Array) -> Array:
    """(4,) log L_ν of one history, relative to the largest; zero where temperature acts, which M leaves out.

    evidence : (Q, P) log likelihoods of `fits` for normal errors, of shapes ``family``; without unit.
    """
    if readings.base.shape[1] > 1:
        return np.zeros(len(FREEDOMS))
    n, k = readings.value.shape
    other = float(np.logaddexp.reduce(evidence.ravel())) - np.log(evidence.size)
    other -= k * (n - 1) / 2 * np.log(2 * np.pi)
    jumps = family.kind == Kind.JUMP
    gap, share = family.gap[jumps], family.share[jumps]
    logs = []
    for freedom in FREEDOMS:
        whole, parted = _levels(readings, freedom, gap)
        jumped = parted + np.log(share * JUMP) - k * np.log(SIZES)
        logs.append(np.logaddexp.reduce([np.log(NOTHING) + whole, np.logaddexp.reduce(jumped), np.log(ELSE) + other]))
    return np.array(logs) - max(logs)


def _levels(readings: Readings, freedom: float, gap: Array) -> tuple[float, Array]:
    """log M(0, n), and log M(0, k)·M(k, n) of jumps before the sessions k (g,), all components together."""
    whole, parted = 0.0, np.zeros(len(gap))
    for value, sigma in zip(readings.value.T, readings.sigma.T, strict=True):
        level = _nodes(value, sigma)
        logs = log_density((value[:, None] - level) / sigma[:, None], freedom) - np.log(sigma)[:, None]
        before = np.cumsum(logs, axis=0)
        step = np.log(level[1] - level[0])
        whole += float(np.logaddexp.reduce(before[-1])) + step
        first, last = (np.logaddexp.reduce(part, axis=1) for part in (before[gap - 1], before[-1] - before[gap - 1]))
        parted += first + last + 2 * step
    return whole, parted


def _nodes(value: Array, sigma: Array) -> Array:
    """(G,) evenly, T, as finely as the level is known."""
    reach = MARGIN * float(np.median(sigma))
    low, high = float(value.min()) - reach, float(value.max()) + reach
    finest = float((sigma**-2.0).sum() ** -0.5)
    return np.linspace(low, high, int(np.clip(2 * (high - low) / finest, COARSEST, FINEST)))
