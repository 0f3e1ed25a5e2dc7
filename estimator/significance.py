"""Chance of a χ² as large, over everything that was tried.

Where the noise is stated, a χ² of n numbers follows its distribution. Where it was estimated with ν degrees of freedom,
χ²/n follows Fisher's F of n and ν.
"""

import numpy as np
from scipy.special import chdtrc, chdtri, fdtrc, fdtri

from estimator.session import Array

FAINTEST_TAIL = 1e-280
"""Tail probability below which its logarithm is taken from the ratio itself; doubles end at 1e-308."""


def p_value(chi2: Array | float, size: Array | float, freedom: float | None = None) -> Array:
    """Probability of a χ² at least this large by chance; 1 where it is of no numbers.

    Parameters
    ----------
    chi2 : any shape, dimensionless.
    size : how many numbers it is of.
    freedom : degrees of freedom of the noise; None or infinite where the noise is stated.
    """
    numbers, square = np.where(np.greater(size, 0), size, 1.0), np.maximum(chi2, 0.0)
    if freedom is None or np.isinf(freedom):
        chance = chdtrc(numbers, square)
    else:
        chance = fdtrc(numbers, np.asarray(freedom), square / numbers)
    return np.where(np.greater(size, 0), chance, 1.0)


def critical_chi2(level: float, size: float, freedom: float | None = None) -> float:
    """χ² of so many numbers that chance exceeds with a probability; ``freedom`` as in `p_value`."""
    if freedom is None or np.isinf(freedom):
        return float(chdtri(size, level))
    return size * float(fdtri(size, freedom, 1 - level))


def family_wise(p: float, tests: float) -> float:
    """p-value of the best of so many tests (Bonferroni)."""
    return min(1.0, p * tests)


def single_level(level: float, tests: int) -> float:
    """Level of each of so many independent tests that have a level together (Šidák 1967, JASA 62, 626)."""
    return float(-np.expm1(np.log1p(-level) / max(tests, 1)))


def equivalent_chi2(power: Array, q: Array, energy: Array, freedom: Array) -> Array:
    """(S,) χ², dimensionless, as unlikely as the ``power`` (S,) that signatures of q (S,) amplitudes explain.

    Where the noise of its sensors is estimated from what it leaves of their readings (``energy`` with ``freedom``,
    (S,); else NaN), F = (power/q)/(energy/freedom) takes the place of χ², carried over at the same tail probability.
    """
    over, amplitudes = np.maximum(freedom, 1.0), np.maximum(q, 1)
    ratio = power / np.maximum(energy, 1e-6 * np.maximum(power, 1e-300))
    tail = fdtrc(amplitudes, over, ratio * over / amplitudes)
    unknown = np.where(
        tail < FAINTEST_TAIL, over * np.log1p(ratio), chdtri(amplitudes, np.maximum(tail, FAINTEST_TAIL))
    )
    return np.where(np.isnan(energy) | (q == 0), power, np.where(freedom > 1, unknown, 0.0))
