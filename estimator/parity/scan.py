"""Finds the time at which a course begins to differ: the likelihood ratio of every onset and end, beside known noise
and motion.

Theory
------
x (T,) is a course in whitened units: parity along one sensor's direction, block by block. Sound, it has the covariance

    R = diag(s²) + Σ_τ q_τ·exp(−|t − t'|/τ) + X·Λ·Xᵀ

s², the noise of every block, comes from the difference of its halves; q_τ, noise of longer memory, from differences of
neighbouring stretches of 1, 2, 4 … blocks (Haar, as the Allan variance); X holds what motion, load and warming do, each
with the size that it has (Λ). None of these is the recording's own scatter: differences over short times hold an onset
once, and the quantiles taken of them leave it out. A change of the shape g and unknown size has the likelihood ratio

    z² = (gᵀR⁻¹x)²/(gᵀR⁻¹g)

(Willsky and Jones 1976, IEEE Trans. Automatic Control 21, 108), over all intervals at once, which looks at every scale
(Arias-Castro, Donoho and Huo 2005, IEEE Trans. Information Theory 51, 2402). The level is family-wise (Bonferroni over
sensors, onsets and scales), with the tail of Student's t, because the noise is known from the recording only.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cholesky, solve_triangular
from scipy.ndimage import median_filter, uniform_filter1d
from scipy.optimize import nnls
from scipy.special import chdtri, ndtri, stdtr, stdtrit

from estimator.session import Array

NEAR = 31
"""Blocks over which the noise of a block is smoothed: a manoeuvre's length; a median of so many is known to a fifth."""
LOCAL = 0.5
"""Least local noise, as a part of the mean square of three blocks: motion shakes a few blocks only."""
FAR = 100.0
"""Noise of a block; how far a course may wander that nothing is said of."""
MEMORIES = (2.0, 8.0, 32.0, 128.0)
"""Blocks; noise of any colour between white and a random walk is a sum of such (Keshner 1982, a factor of four)."""
SCALES = 8
"""Neighbouring stretches that the longest scale must leave in the recording."""
SOUND = 0.4
"""Part of a recording's differences that is taken for sound: onsets and what follows may hold the rest."""
LEAST_NORM = 1e-5
"""Share of a change, in energy, that noise and motion must leave: the rounding of R."""


@dataclass(frozen=True, eq=False)
class Scan:
    """One course, whitened. T blocks."""

    root: Array
    """(T, T) lower Cholesky factor of R."""
    white: Array
    """(T,) R's root⁻¹·x, dimensionless."""
    variance: Array
    """(T,) s², for the share of a shape that is left."""

    def whitened(self, shapes: Array) -> Array:
        """(T, n) root⁻¹·g of shapes (T, n)."""
        return np.asarray(solve_triangular(self.root, shapes, lower=True, check_finite=False))

    def ratios(self, shapes: Array) -> Array:
        """(n,) z of shapes (T, n), signed; 0 where hardly anything is left of one."""
        g = self.whitened(shapes)
        norm = (g**2).sum(axis=0)
        plain = (shapes**2 / self.variance[:, None]).sum(axis=0)
        return np.where(norm > LEAST_NORM * plain, (g.T @ self.white) / np.sqrt(np.maximum(norm, 1e-30)), 0.0)

    def size(self, shape: Array) -> tuple[float, float]:
        """Size and sigma of a shape (T,), units of x."""
        g = self.whitened(shape[:, None])[:, 0]
        norm = max(float(g @ g), 1e-30)
        return float(g @ self.white) / norm, norm**-0.5

    def intervals(self) -> Array:
        """(T + 1, T + 1) z of a shift from one block until before another; 0 where there is none."""
        T = len(self.white)
        g = self.whitened(np.tri(T))
        c, N = np.zeros(T + 1), np.zeros((T + 1, T + 1))
        c[:T], N[:T, :T] = g.T @ self.white, g.T @ g
        norm = np.diag(N)[:, None] + np.diag(N) - 2 * N
        plain = np.concatenate([[0.0], np.cumsum(1.0 / self.variance)])
        left = norm > LEAST_NORM * np.abs(plain[:, None] - plain)
        z = np.where(left, (c[:, None] - c) / np.sqrt(np.maximum(norm, 1e-30)), 0.0)
        return np.tril(np.triu(z, SHORTEST), T - SHORTEST)


SHORTEST = 2
"""Blocks of the shortest shift, and of what lies beside it: one block alone may be a knock, or a clipped peak."""


def scan_of(x: Array, variance: Array, colour: Array, fixed: Array) -> Scan:
    """The scan of a course x (T,) with the variances of its blocks (T,), colours q (τ,) and X·Λ·Xᵀ (T, T)."""
    R = covariance(variance, colour, fixed)
    root = cholesky(R, lower=True, check_finite=False)
    return Scan(root, solve_triangular(root, x, lower=True, check_finite=False), variance)


def covariance(variance: Array, colour: Array, fixed: Array) -> Array:
    """(T, T) R."""
    R = fixed + np.diag(variance)
    for tau, q in zip(MEMORIES, colour, strict=True):
        R += q * remembered(len(variance), tau) if q > 0 else 0.0
    return np.asarray(R)


def remembered(T: int, tau: float) -> Array:
    """(T, T) exp(−|t − t'|/τ)."""
    t = np.arange(T)
    return np.asarray(np.exp(-np.abs(t[:, None] - t) / tau))


def block_variance(halves: Array) -> Array:
    """(T,) variance of a block's mean from the differences of its halves (T, n), n courses alike; their unit squared.

    Local: the median over neighbours, which an onset does not move.
    """
    n = halves.shape[1]
    square = (halves**2).mean(axis=1)
    typical = median_filter(square, size=min(NEAR, len(square)), mode="nearest") * n / chdtri(n, 0.5)
    knocked = LOCAL * uniform_filter1d(square, 3, mode="nearest")
    return np.asarray(np.maximum(np.maximum(typical, knocked), 0.1 * np.median(square) + np.finfo(float).tiny))


def colour_of(courses: Array, variance: Array, fixed: Array, part: float, *, wandering: bool = False) -> Array:
    """(τ,) q of courses (T, n) alike, freed of motion, from the given part of their differences, whitened units.

    ``wandering`` lets the courses go anywhere slowly, so that an onset does not bend the rest; only short memory is
    then seen.
    """
    wander = np.zeros(len(MEMORIES))
    wander[2] = FAR**2 * float(np.median(variance)) if wandering else 0.0
    R = covariance(variance, wander, fixed)
    left = variance[:, None] * np.linalg.solve(R, courses)
    T = len(left)
    lengths = [2**k for k in range(12) if 2**k * SCALES <= T]
    seen, model, white = [], [], []
    total = np.vstack([np.zeros((1, left.shape[1])), np.cumsum(left, axis=0)])
    power = np.concatenate([[0.0], np.cumsum(variance)])
    for length in lengths:
        at = np.arange(0, T - 2 * length + 1, max(length // 2, 1))
        D = (total[at + 2 * length] - 2 * total[at + length] + total[at]) / length
        noise = (power[at + 2 * length] - power[at]) / length**2
        share = np.quantile(np.abs(D) / np.sqrt(noise)[:, None], part) / ndtri(0.5 + part / 2)
        typical = float(np.median(noise))
        seen.append(max(share**2 - 1.0, 0.0) * typical)
        white.append(typical)
        f = np.concatenate([-np.ones(length), np.ones(length)]) / length
        model.append([f @ remembered(2 * length, tau) @ f for tau in MEMORIES])
    weight = 1.0 / (np.array(seen) + np.array(white))
    return np.asarray(nnls(np.array(model) * weight[:, None], np.array(seen) * weight)[0])


def critical(level: float, tests: float, freedom: float) -> float:
    """z from which one of so many is called a change at a family-wise level; noise of ``freedom``."""
    return float(-stdtrit(freedom, level / tests / 2))


def tail(z: float, tests: float, freedom: float) -> float:
    """p-value of the largest |z| of so many."""
    return float(min(1.0, 2.0 * tests * stdtr(freedom, -abs(z))))
