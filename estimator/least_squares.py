"""Weighted least squares, from rows in standard errors or from the scores and information that they add up to.

Columns are compared at length one, whatever their units: a direction whose singular value is a smaller share of the
largest than ``faint`` counts as none. With the pseudo-inverse X⁺ of the columns the estimate is X⁺y, its covariance
X⁺X⁺ᵀ. A prior of information π on an amplitude is a row more, √π of it read as zero.

Of U = Xᵀy and F = XᵀX, what the columns c tell once the columns a are left free is

    U − F_ca·F_aa⁻¹·U_a,   F − F_ca·F_aa⁻¹·F_ac.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.arrays import eigh
from estimator.session import Array

FLAT = 1e-9
"""Share of the largest singular value below which a direction of columns is rounding."""

FAINT = 1e-6
"""Relative size below which a direction of an information that was added up and kept in steps is rounding."""


@dataclass(frozen=True, eq=False)
class LeastSquaresFit:
    """A regression on q columns."""

    value: Array
    """(q, …) coefficients in the columns' units."""
    covariance: Array
    """(q, q)."""
    chi2: Array
    """(…) χ² of the residuals, of the prior's rows too."""
    rank: int
    """Directions that count."""
    freedom: int
    """Degrees of freedom: rows, those of the prior among them, less the rank."""


def least_squares(columns: Array, values: Array, faint: float = FLAT, prior: Array | None = None) -> LeastSquaresFit:
    """The regression of values (N, …) on columns (N, q), both in standard errors.

    prior : (q,) information of every amplitude about zero beforehand, one over its unit squared.
    """
    if prior is not None:
        columns = np.concatenate([columns, np.diag(np.sqrt(prior))])
        values = np.concatenate([values, np.zeros((len(prior), *values.shape[1:]))])
    basis, inverse = decomposed(columns, faint)
    residual = values - basis @ (basis.T @ values)
    rank = basis.shape[1]
    return LeastSquaresFit(inverse @ values, inverse @ inverse.T, (residual**2).sum(axis=0), rank, len(columns) - rank)


def decomposed(columns: Array, faint: float = FLAT) -> tuple[Array, Array]:
    """(N, r) orthonormal directions of columns (N, q), dimensionless, and (q, N) their pseudo-inverse."""
    size = np.linalg.norm(columns, axis=0)
    size = np.where(size > 0, size, 1.0)
    left, value, right = np.linalg.svd(columns / size, full_matrices=False)
    live = value > faint * value.max(initial=0.0)
    basis = left[:, live]
    return basis, (right[live].T / value[live]) @ basis.T / size[:, None]


def orthonormal(columns: Array, faint: float) -> Array:
    """(N, r) orthonormal directions of columns (N, q) in any units, dimensionless; those that vanish count as none."""
    size = np.linalg.norm(columns, axis=0)
    basis, value, _ = np.linalg.svd(columns[:, size > 0] / size[size > 0], full_matrices=False)
    return basis[:, value > faint * value.max(initial=0.0)]


def scale_of(F: Array) -> Array:
    """(…, q) factors that give an information (…, q, q) a diagonal of one; 0 where it says nothing."""
    size = np.sqrt(np.maximum(np.diagonal(F, axis1=-2, axis2=-1), 0.0))
    return np.where(size > 0, 1 / np.where(size > 0, size, 1.0), 0.0)


def inverse(F: Array, faint: float = FAINT) -> Array:
    """(q, q) pseudo-inverse of an information (q, q) in any units, its faint directions left out."""
    scale = scale_of(F)
    value, vector = eigh(F * scale[:, None] * scale)
    live = value > faint * max(value.max(initial=0.0), 1e-300)
    part = vector[:, live]
    return np.asarray(scale[:, None] * (part / value[live]) @ part.T * scale)


def given(U: Array, F: Array, free: Sequence[int] | Array, energy: float) -> tuple[Array, Array]:
    """Scores (D, …) and information (D, D) given some columns left free; 0 of a column of whose information these leave
    no more than the share ``energy``."""
    indices = np.asarray(free, dtype=int)
    cross = F[:, indices] @ inverse(F[np.ix_(indices, indices)])
    score, rest = U - cross @ U[indices], F - cross @ F[indices]
    gone = np.diagonal(rest) <= energy * np.diagonal(F)
    rest[gone], rest[:, gone], score[gone] = 0.0, 0.0, 0.0
    return score, rest
