"""The overlapping Allan variance of readings at rest, at octaves of τ, pooled over all rests.

With x the running sum of y·τ₀ and τ = m·τ₀, σ²(τ) is the mean of (x(t + 2τ) − 2x(t + τ) + x(t))²/(2τ²) over every t at
which both averages lie in one rest (NIST SP 1065, eq. 11). A rest gives τ up to an eighth of its length: longer ones
have so few degrees of freedom that they tell nothing.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.session import Array

SHARE = 8
"""The longest τ is this fraction of a rest, one over `SHARE`, with some ten degrees of freedom."""
PHASES = 16
"""Overlapping differences a τ: more repeat one another, and sixteen lose nothing that counts."""
ENDS = 4 / 3
"""τ by which a rest is worth less than its length: two averages need two, and the overlap gives two thirds back, as in
the degrees of freedom for white noise, 3T/(2τ) − 2 (NIST SP 1065, table 5)."""


@dataclass(frozen=True, eq=False)
class Variances:
    """The Allan variances of m sensors at J times."""

    interval: float
    """s, τ₀ from sample to sample."""
    factor: Array
    """(J,) τ/τ₀, powers of two."""
    value: Array
    """(J, m) σ²(τ), units of the readings squared."""
    length: Array
    """(J,) s, effective length of all rests that give a τ."""
    shared: Array
    """(J, J) s, the same of those that give both of two τ."""

    @property
    def tau(self) -> Array:
        """(J,) s."""
        return self.factor * self.interval


def variances(rests: Sequence[Array], interval: float) -> Variances | None:
    """Allan variances of readings (n, m), any unit, of every rest, one sample each ``interval`` s; None where no rest
    is long enough.

    A rest that gives no τ at all is left out.
    """
    longest = max((len(rest) for rest in rests), default=0) // SHARE
    if longest < 1:
        return None
    factor = 2 ** np.arange(int(np.log2(longest)) + 1)
    m = rests[0].shape[1]
    sums, counts = np.zeros((len(factor), m)), np.zeros(len(factor))
    worth = np.zeros((len(factor), len(rests)))
    for r, rest in enumerate(rests):
        phase = np.concatenate([np.zeros((1, m)), np.cumsum(rest - rest.mean(axis=0), axis=0)])
        for j in range(np.searchsorted(factor, len(rest) // SHARE, "right")):
            squares = _squares(phase, int(factor[j]))
            sums[j] += squares.sum(axis=0)
            counts[j] += len(squares)
            worth[j, r] = (len(rest) - ENDS * factor[j]) * interval
    weight = worth / worth.sum(axis=1, keepdims=True)
    value = sums / counts[:, None]
    within = np.minimum(worth[:, None], worth[None])
    shared = 1 / np.maximum((weight[:, None] * weight[None] / np.where(within > 0, within, np.inf)).sum(axis=2), 1e-300)
    return Variances(interval, factor, value, np.diag(shared).copy(), shared)


def _squares(phase: Array, m: int) -> Array:
    """(n, m) squared changes of averages over ``m`` samples, of running sums (n + 1, m), their unit squared."""
    step = max(1, m // PHASES)
    ends = phase[::step]
    k = m // step
    change = ends[2 * k :] - 2 * ends[k:-k] + ends[: -2 * k]
    return np.asarray(change**2 / (2 * m**2))
