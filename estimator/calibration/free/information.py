"""The information in a set of orientations: rank, weakest direction, covariance. Planning uses it too, as it needs no
readings.

Without stated directions every common turn of axes and orientations fits the same, so the frame is held by the nominal
axes: the estimated axes show no net turn against them, Σ e_nominal,i × e_i = 0 (the condition under which the Kabsch
rotation of one set to the other is the identity). The covariance obeys that constraint.
"""

from dataclasses import dataclass

import numpy as np

from estimator.arrays import eigh
from estimator.calibration.free.model import Linear, ModelRows, Unknowns, linearise
from estimator.parameters import PLAUSIBLE
from estimator.session import Array

ROUNDING = 1e-12
"""Eigenvalues of the information below this part of the largest are rounding, not knowledge: a hundred times that of
`calibration.observability`, because eliminating the orientations takes a difference of large numbers."""

NEXT, LAST = [1, 2, 0], [2, 0, 1]
"""Cyclic indices for cross products: a × b is a[NEXT]·b[LAST] − a[LAST]·b[NEXT]."""

QUADRATIC = 2
"""Place of the quadratic term among a sensor's five elements."""


@dataclass(frozen=True, eq=False)
class Information:
    """Knowledge of the free parameters. P = 5 m; fixed elements have zero rows and columns everywhere."""

    basis: Array
    """(P, F) orthonormal: the directions in which the parameters may move."""
    seen: Array
    """(P, rank) eigenvectors that the set determines."""
    unseen: Array
    """(P, F − rank) eigenvectors that it does not."""
    variances: Array
    """(rank,) variances along the seen directions, dimensionless."""
    weakest: tuple[int, float]
    """Element that leads the least known direction, and that direction's one sigma."""

    @property
    def rank(self) -> int:
        """Directions that the set determines."""
        return self.seen.shape[1]

    @property
    def parameters(self) -> int:
        """Directions in which the parameters may move."""
        return self.basis.shape[1]

    @property
    def full(self) -> bool:
        """Whether the set determines everything that may move."""
        return self.rank == self.parameters

    @property
    def covariance(self) -> Array:
        """(P, P) dimensionless, of the seen part: elements that an unseen direction moves have more than this."""
        return (self.seen * self.variances) @ self.seen.T


def movable(rows: ModelRows, unknowns: Unknowns, quadratic: bool) -> Array:
    """(5 m, F) orthonormal basis, dimensionless, of what may move: no fixed elements, and no net turn of the axes where
    no stated directions hold the frame."""
    m = len(unknowns.axes)
    free = np.ones(5 * m, dtype=bool)
    free[QUADRATIC::5] = quadratic
    if rows.held:
        return np.eye(5 * m)[:, free]
    constraint = np.zeros((3, m, 5))
    turns, n = unknowns.axis_tangents, rows.nominal_axes[:, :, None]
    crossed = n[:, NEXT] * turns[:, LAST] - n[:, LAST] * turns[:, NEXT]
    constraint[:, :, 3:] = np.swapaxes(crossed, 0, 1)
    null_basis = np.linalg.svd(constraint.reshape(3, 5 * m)[:, free])[2][3:].T
    basis = np.zeros((5 * m, null_basis.shape[1]))
    basis[free] = null_basis
    return basis


def unseen_below(values: Array) -> float:
    """Eigenvalue at or below which a direction counts as not determined; values (F,) rising, dimensionless."""
    return max(PLAUSIBLE**-2, ROUNDING * float(values[-1]))


def information(rows: ModelRows, unknowns: Unknowns, quadratic: bool, linear: Linear | None = None) -> Information:
    """The information of orientations ``unknowns.directions`` on such sensors, under the noise of ``rows``.

    Only `rows.sigma`, `rows.prior` and `rows.nominal_axes` are used: the readings play no part. ``linear`` is the
    linearisation there, where it is at hand.
    """
    basis = movable(rows, unknowns, quadratic)
    schur = (linear or linearise(rows, unknowns)).schur
    values, vectors = eigh(basis.T @ schur @ basis)
    vectors = basis @ vectors
    known = values > unseen_below(values)
    lead = int(np.argmax(np.abs(vectors[:, 0])))
    return Information(
        basis=basis,
        seen=vectors[:, known],
        unseen=vectors[:, ~known],
        variances=1.0 / values[known],
        weakest=(lead, float(1.0 / np.sqrt(max(values[0], 0.0) + 1.0))),
    )
