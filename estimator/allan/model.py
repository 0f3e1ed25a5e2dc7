"""The four noises: their Allan variances, and how estimates of them scatter together.

The estimate of σ²(τ_i) is the mean of squares of a stationary Gaussian process with the spectrum P_i = S·|H_i|²,
|H_m|² = 2 sin⁴(πmfτ₀)/(m sin πfτ₀)². So, for a record of length T that is long against τ,

    cov(σ̂²_i, σ̂²_j) = (1/T)·∫ P_i·P_j df,      0 < f < 1/(2τ₀),

one-sided spectra. S is a sum over the terms, so the integral is a quadratic form of their squared sizes, whose
coefficients are worked out once. With 2σ⁴/var as degrees of freedom this gives for pure noises those of Greenhall and
Riley (2003, Proc. 35th PTTI, 267), to which it is compared in the tests.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from estimator.allan.variance import Variances
from estimator.session import Array

QUANTISATION, WHITE, INSTABILITY, RANDOM_WALK = range(4)
"""Columns of the terms, shortest τ first."""
FLICKER = 2 * np.log(2) / np.pi
"""σ² of flicker of size B, over B²."""
POINTS = 12_000
"""Frequencies of the integrals; twice as many change no entry by more than half a per cent."""
BELOW = 30
"""Lowest frequency of the integrals, in parts of the inverse of the longest τ: below, |H|² falls as f²."""


@dataclass(frozen=True, eq=False)
class AllanModel:
    """Model of Allan variances at J times."""

    shapes: Array
    """(J, 4) σ² of every term of size one."""
    products: Array
    """(4, 4, J, J) covariances of the estimates, of two terms of size one."""

    def covariance(self, squares: Array) -> Array:
        """(J, J) covariance of the estimates for squared sizes (4,), units squared."""
        total = np.einsum("k,l,klij->ij", squares, squares, self.products)
        return np.asarray(total)


def model_of(seen: Variances) -> AllanModel:
    """The model for the times and lengths of a record."""
    tau = seen.tau
    shapes = np.column_stack([3 / tau**2, 1 / tau, np.full(len(tau), FLICKER), tau / 3])
    return AllanModel(shapes, _integrals(seen.interval, len(tau)) / seen.shared)


@lru_cache(maxsize=8)
def _integrals(interval: float, octaves: int) -> Array:
    """(4, 4, J, J) integrals of P_i·P_j for two terms of size one, times s."""
    factor = 2.0 ** np.arange(octaves)
    highest = 0.5 / interval
    log_f = np.linspace(np.log(highest / (factor[-1] * BELOW)), np.log(highest), POINTS)
    f = np.exp(log_f)
    weight = f * (log_f[1] - log_f[0])
    weight[[0, -1]] /= 2
    sine = np.sin(np.pi * f * interval)
    gain = 2 * np.sin(np.pi * factor[:, None] * f * interval) ** 4 / (factor[:, None] * sine) ** 2
    spectra = (8 * sine**2 / interval, np.full(POINTS, 2.0), 1 / (np.pi * f), 2 / (2 * np.pi * f) ** 2)
    integrals = np.empty((4, 4, octaves, octaves))
    for k, spectrum in enumerate(spectra):
        for n, other in enumerate(spectra):
            integrals[k, n] = (gain * (weight * spectrum * other)) @ gain.T
    return integrals
