"""Allan variances → the four sizes with their uncertainties, and the times at which they describe the record.

The squared sizes θ ≥ 0 solve the quasi-likelihood equations Aᵀ·C(θ)⁻¹·(σ̂² − Aθ) = 0 with the covariance C of `model`
at the fit itself, so that a low estimate does not gain weight (McCullagh & Nelder 1989, 9.2). Their covariance is
(Aᵀ·C⁻¹·A)⁻¹. A size is decided where θ exceeds `DECIDED` of its sigmas; otherwise only a bound is stated.

Filters shorten the slope at short τ, temperature and lines in the spectrum bend it at long ones. So the terms are
asked to describe the whole curve, and if they do not, the longest run of octaves at which they do: the residuals,
made normal by their cube roots (Wilson & Hilferty 1931), have a χ² with as many degrees of freedom as octaves less
terms.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls
from scipy.special import gammaincc

from estimator.allan.model import AllanModel
from estimator.least_squares import inverse
from estimator.session import Array

DECIDED = 3.0
"""Sigmas of θ: white noise alone is then called something else as well in fewer than one record of a hundred."""
ROUNDS = 12
"""Rounds of weights at the fit; the sizes settle to a thousandth in four or five."""
FEWEST = 5
"""Octaves of a run: one more than there are terms."""
MISFIT = 1e-3
"""Probability of a χ² as large, below which the terms do not describe a run."""
LIMIT = 1.96
"""Sigmas above θ ≥ 0 that a term which is not decided hardly exceeds."""


@dataclass(frozen=True, eq=False)
class AllanFit:
    """The fitted sizes of one sensor."""

    square: Array
    """(4,) θ, squared sizes."""
    sigma: Array
    """(4,) one sigma of θ."""
    first: int
    """Octave of the run's shortest τ."""
    end: int
    """One past that of its longest."""

    @property
    def decided(self) -> Array:
        """(4,) bool; what falls as τ⁻² at later times only is no rounding from sample to sample."""
        seen = np.array([self.first == 0, True, True, True])
        return np.asarray(seen & (self.square > 0) & (self.square > DECIDED * self.sigma))

    @property
    def most(self) -> Array:
        """(4,) sizes that the terms hardly exceed."""
        return np.sqrt(self.square + LIMIT * self.sigma)


def fit(model: AllanModel, value: Array) -> AllanFit | None:
    """Fits variances (J,), units squared, each above 0; None where the terms describe no run of octaves."""
    for first, end in _runs(len(value)):
        candidate = _fitted(model, value, first, end)
        if candidate is not None:
            return candidate
    return None


def _runs(count: int) -> Iterator[tuple[int, int]]:
    """First and end of every run of octaves, the longest first, of equally long ones that of short τ first."""
    for length in range(count, FEWEST - 1, -1):
        yield from ((first, first + length) for first in range(count - length + 1))


def _fitted(model: AllanModel, value: Array, first: int, end: int) -> AllanFit | None:
    """Fits one run of octaves; None where the terms do not describe it."""
    octaves = slice(first, end)
    A, seen = model.shapes[octaves], value[octaves]
    products = model.products[:, :, octaves, octaves]
    part = AllanModel(A, products)
    C = np.diag(seen**2 * np.diag(_relative(part)))
    theta = np.zeros(4)
    for _ in range(ROUNDS):
        theta = _weighted(A, seen, C)
        C = part.covariance(theta)
    if not _describes(A @ theta, C, seen, int(np.count_nonzero(theta))):
        return None
    sigma = _sigmas(A, C)
    scatter = part.covariance(np.where(theta > DECIDED * sigma, theta, theta + sigma))
    return AllanFit(theta, _sigmas(A, scatter), first, end)


def _relative(part: AllanModel) -> Array:
    """(J, J) covariance of white noise's estimates over their values: where the weights begin."""
    white = np.array([0.0, 1.0, 0.0, 0.0])
    shape = part.shapes @ white
    return part.covariance(white) / np.outer(shape, shape)


def _weighted(A: Array, seen: Array, C: Array) -> Array:
    """(4,) θ ≥ 0 of least weighted squares."""
    L = np.linalg.cholesky(C)
    size = np.linalg.norm(np.linalg.solve(L, A), axis=0)
    solution, _ = nnls(np.linalg.solve(L, A) / size, np.linalg.solve(L, seen))
    return np.asarray(solution / size)


def _sigmas(A: Array, C: Array) -> Array:
    """(4,) one sigma of θ, all terms estimated together: a term estimated as zero may be there all the same."""
    information = A.T @ np.linalg.solve(C, A)
    return np.asarray(np.sqrt(np.diag(inverse(information, 1e-15))))


def _describes(expected: Array, C: Array, seen: Array, terms: int) -> bool:
    """Whether the observed variances (J,) scatter about the expected ones (J,) as the covariance C (J, J) allows."""
    variance = np.diag(C) / expected**2
    third = variance / 9
    normal = (np.cbrt(seen / expected) - (1 - third)) / np.sqrt(third)
    scale = np.sqrt(np.diag(C))
    statistic = normal @ np.linalg.solve(C / np.outer(scale, scale), normal)
    return bool(gammaincc((len(seen) - terms) / 2, statistic / 2) > MISFIT)
