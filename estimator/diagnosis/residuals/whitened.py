"""Whitened residuals of a session, the baseline projected out: where causes leave their traces.

Theory
------
Residuals of one row share the row's nuisances; `Whitener` multiplies by the inverse root of their covariance. Constant
nuisances enter as columns with prior rows. Everything that the baseline can absorb is an orthonormal basis; what a
signature leaves outside it is its trace, whose norm is the effect's strength in standard errors.

With history, rows are appended: the whitened deviation of the parameters from the history, and how each cause would
have moved them. Residuals of a fit and its parameters are independent, so both kinds of rows stand side by side.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from estimator.causes.contract import Setting
from estimator.diagnosis.residuals.baseline import Baseline, Whitener
from estimator.session import Array

INVISIBLE = 1e-3
"""Share of a signature that the baseline must leave for it to be visible: below it the effect would have to be a
thousand times what is seen of it, beyond what the linearised model describes."""


@dataclass(frozen=True, eq=False)
class ParameterChange:
    """The change of the parameters since the history, whitened. P = 5 m parameters."""

    deviation: Array
    """(P,) standard errors: deviation of this session's parameters from the history."""
    inverse_root: Array
    """(P, P) inverse root of the deviation's covariance: whitens a dimensionless parameter change."""
    earlier: tuple["EarlierSession", ...] = ()
    """The sessions that the reference is made of."""


@dataclass(frozen=True, eq=False)
class EarlierSession:
    """One session of the history and its part in the reference."""

    residuals: "WhitenedResiduals"
    share: Array
    """(P, P) dimensionless: change of the reference, seen from now, with the parameters found in that session."""
    setting: Setting
    """Setting of that session, at the parameters of the present one."""

    @cached_property
    def absorbs(self) -> Array:
        """(P, R, m) per m/s² (rad/s): change of the reference with the input of every reading of that session."""
        R, m = self.residuals.baseline.residual.shape
        moved = self.share @ self.residuals.response[:, : R * m]
        return self.residuals.whiten.transposed(moved.reshape(-1, R, m))


@dataclass(frozen=True, eq=False)
class WhitenedResiduals:
    """Whitened and projected residuals of one session. N = R·m + k rows: readings, then the priors of k nuisances.

    With history, P = 5 m rows of the parameters' change follow; n is the number of all rows.
    """

    baseline: Baseline
    whiten: Whitener
    basis: Array
    """(N, p) orthonormal: what the baseline absorbs."""
    response: Array
    """(P, N) dimensionless: change of the parameters with a whitened change of the readings (pseudo-inverse)."""
    z: Array
    """(n,) standard errors: the residuals."""
    change: ParameterChange | None
    freedom: int
    """Degrees of freedom of the readings' residuals."""

    @classmethod
    def of(cls, baseline: Baseline, change: ParameterChange | None = None) -> "WhitenedResiduals":
        """The residuals of a fitted session, with its change since the history."""
        whiten, k = baseline.whiten, len(baseline.constant_sigma)
        basis, response = baseline.absorption.basis, baseline.absorption.response
        data = np.concatenate([whiten(baseline.residual[..., None])[:, 0], np.zeros(k)])
        z = data - basis @ (basis.T @ data)
        if change is not None:
            z = np.concatenate([z, change.deviation])
        freedom = baseline.residual.size - int(whiten.projected_out.sum()) - (basis.shape[1] - k)
        return cls(baseline, whiten, basis, response, z, change, freedom)

    @cached_property
    def row_freedom(self) -> Array:
        """(N,) degrees of freedom of every row: one less its leverage in directions and baseline, dimensionless."""
        known = np.ones(self.rows)
        unknown = (self.whiten.direction**2 * self.whiten.projected_out[:, None, :]).sum(axis=-1)
        known[: unknown.size] -= unknown.ravel()
        return known - (self.basis**2).sum(axis=1)

    @property
    def rows(self) -> int:
        """N, number of reading and prior rows."""
        return self.basis.shape[0]

    def whitened(self, columns: Array) -> Array:
        """(N, q) standard errors: a signature (R, m, q), m/s² (rad/s), before the baseline absorbs its share."""
        white = self.whiten(columns)
        return np.concatenate([white, np.zeros((self.rows - len(white), white.shape[1]))])

    def trace(self, columns: Array, before: Array | float | None = None) -> Array:
        """(n, q) standard errors: what a signature (R, m, q), m/s² (rad/s), leaves.

        What the baseline absorbs of it shows as a change of the parameters, unless it was there ``before``: (P, q)
        dimensionless, what the history absorbed of it; 0 of what is new, None where it absorbed as much as now.
        """
        return self.remaining_of(self.whitened(columns), before)

    def remaining_of(self, white: Array, before: Array | float | None = None) -> Array:
        """(n, q) standard errors: the part of a signature, `whitened` (N, q), that the baseline leaves."""
        inside = white - self.basis @ (self.basis.T @ white)
        if self.change is None:
            return inside
        if before is None:
            return np.concatenate([inside, np.zeros((len(self.change.deviation), white.shape[1]))])
        return np.concatenate([inside, self.change.inverse_root @ (self.response @ white - before)])

    @cached_property
    def sensor_of_row(self) -> Array:
        """(n,) int, number of the sensor that a row belongs to; −1 for priors."""
        R, m = self.baseline.residual.shape
        sensor = np.full(len(self.z), -1)
        sensor[: R * m] = np.tile(np.arange(m), R)
        if self.change is not None:
            sensor[self.rows :] = np.repeat(np.arange(m), 5)
        return sensor
