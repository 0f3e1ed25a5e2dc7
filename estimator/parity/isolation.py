"""The size from which a change of one sensor is attributed to it, in 95 of 100 recordings.

A change of size μ standard errors, whose signature is the unit vector s, is lost in three ways: it is not detected; a
hypothesis of another sensor comes within Δ of the best; the best leaves more than noise, by chance. The ratio of a
hypothesis with basis U is χ² of k numbers, moved by μ²ρ², ρ = |Uᵀs|; that of the true one by μ². Their difference has
mean μ²(1 − ρ²) + k_true − k and variance 4μ²(1 − ρ²) + 2k. Scores are taken at the means. The chances are added up,
sensor by sensor (Bonferroni), each rival sensor by its best hypothesis.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import log_ndtr, ndtr, stdtr

from estimator.session import Array

SIZES = np.geomspace(1.0, 500.0, 256)
"""Standard errors that are tried, in steps of 2.5 %. A change that needs more is no longer small."""
STRIDE = 16
"""Sizes between those that are looked at first: what is lost falls with the size, so one stretch decides."""
DIRECTIONS = 8
"""Directions of a turn in which its size is tested: the worst of eight is within 2 % of the true worst."""


@dataclass(frozen=True, eq=False)
class Rivals:
    """All n hypotheses, with the numbers by which one is chosen."""

    bases: Array
    """(n, q, 4) orthonormal, filled up with zeros."""
    count: NDArray[np.intp]
    """(n,) numbers of each."""
    sensor: NDArray[np.intp]
    """(n,)"""
    margin: float
    """Δ, by which a score must lead."""
    threshold: float
    """Standard errors from which a change of one number is detected."""
    dof: float
    """Degrees of freedom of the noise."""
    lost: float
    """Chance that may be lost in all, less what is lost to chance leftovers."""

    def least_size(self, whitened: Array, sensor: int) -> float | None:
        """Size of a change with signature ``whitened`` (q, k), standard errors per unit, that is attributed to its
        sensor; for two numbers in the worst direction. None where no size is enough.
        """
        worst = 0.0
        for direction in _directions(whitened.shape[1]):
            along = whitened @ direction
            length = float(np.linalg.norm(along))
            size = self._standard_errors(along / length, sensor, whitened.shape[1])
            if size is None:
                return None
            worst = max(worst, size / length)
        return worst

    def _standard_errors(self, signature: Array, sensor: int, k: int) -> float | None:
        """The first of `SIZES` from which on no more is lost than may be; signature (q,) of length one."""
        shared = np.minimum(((np.swapaxes(self.bases, 1, 2) @ signature) ** 2).sum(axis=1), 1.0)
        coarse = SIZES[STRIDE - 1 :: STRIDE]
        fails = np.flatnonzero(self._lost(coarse, shared, sensor, k) > self.lost)
        if len(fails) and fails[-1] == len(coarse) - 1:
            return None
        first = STRIDE * (fails[-1] + 1) if len(fails) else 0
        stretch = SIZES[first : first + STRIDE]
        fails = np.flatnonzero(self._lost(stretch, shared, sensor, k) > self.lost)
        return float(stretch[fails[-1] + 1 if len(fails) else 0])

    def _lost(self, sizes: Array, shared: Array, sensor: int, k: int) -> Array:
        """(s,) chance to lose a change of ``sizes`` (s,), standard errors; shared (n,) ρ² with each hypothesis."""
        square, shared = sizes**2, shared[:, None]
        threshold = score(square + k, np.array([k]))
        lead = threshold - score(shared * square + self.count[:, None], self.count)
        spread = np.sqrt(4.0 * square * (1.0 - shared) + 2.0 * self.count[:, None])
        passed = stdtr(self.dof, (self.margin - lead) / spread)
        lost = ndtr((self.threshold - sizes) / shortfall(self.threshold, self.dof))
        for rival in np.unique(self.sensor[self.sensor != sensor]):
            lost = lost + passed[self.sensor == rival].max(axis=0)
        return np.asarray(lost)


def shortfall(threshold: float, dof: float) -> float:
    """Standard errors by which a change of one number misses a threshold: its own, and the threshold's, which moves
    with a standard error that is itself known from ``dof`` numbers only.
    """
    return float(np.sqrt(1.0 + threshold**2 / (2.0 * dof)))


def _directions(k: int) -> Array:
    """(n, k) unit vectors over a half of the circle; one for one number."""
    if k == 1:
        return np.ones((1, 1))
    angle = np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    return np.column_stack([np.cos(angle), np.sin(angle)])


def score(ratio: Array, count: Array) -> Array:
    """(n, ...) −2 ln of the chance of ratios (n, ...), dimensionless, of ``count`` (n,) numbers each."""
    return np.stack([-2.0 * log_tail(x, int(k)) for x, k in zip(np.atleast_2d(ratio), count, strict=True)])


def log_tail(x: Array, k: int) -> Array:
    """ln of the upper tail of χ² with k = 1 to 4 degrees of freedom, in closed form; 0 for none.

    x may be large, and `scipy.stats.chi2.logsf` is −∞ from about 1,500 on.
    """
    if k == 0:
        return np.zeros_like(x)
    if k % 2 == 0:
        return np.asarray(-x / 2 + (np.log1p(x / 2) if k == 4 else 0.0))
    first = np.log(2.0) + log_ndtr(-np.sqrt(x))
    return np.asarray(first if k == 1 else np.logaddexp(first, 0.5 * np.log(2 * x / np.pi) - x / 2))
