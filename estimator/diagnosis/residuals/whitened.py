"""Whitened residuals of a session, the baseline projected out: where causes leave their traces.

Theory
------
Residuals of one row share the row's nuisances: D + H S H' with D diagonal. `Whitener` multiplies by the inverse root
(D in each sensor's own sigma, then shrinking the nuisance directions by 1/√(1 + s²), to zero where s is infinite).
Constant nuisances enter as columns with prior rows. Everything that the baseline can absorb is an orthonormal basis;
what a signature leaves outside it is its trace, whose norm is the effect's strength in standard errors.

With history, rows are appended: the whitened deviation of the parameters from the history, and how each cause would
have moved them. Residuals of a fit and its parameters are independent, so both kinds of rows stand side by side.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from estimator.diagnosis.residuals.baseline import Baseline, block_columns
from estimator.diagnosis.residuals.gauge import observable_directions
from estimator.parameters import PLAUSIBLE
from estimator.session import Array

RANK = 1e-9
"""Relative singular value below which a direction of the baseline or of a row's nuisances counts as none: rounding
leaves 1e-16 to 1e-14 where a session observes nothing."""


@dataclass(frozen=True, eq=False)
class Whitener:
    """Inverse root of the noise covariance of every row. R rows, m sensors, r nuisances a row."""

    weight: Array
    """(R, m) inverse sigma of the independent noise, 1/(m/s²) (1/(rad/s))."""
    direction: Array
    """(R, m, r) orthonormal nuisance directions in units of the independent noise."""
    removed: Array
    """(R, r) share of each direction that is taken away, 1 − 1/√(1 + s²)."""

    @classmethod
    def of(cls, baseline: Baseline) -> "Whitener":
        """From the noise and the nuisances of a baseline."""
        weight = 1.0 / np.sqrt(baseline.variance)
        unknown = np.isinf(baseline.row_sigma)
        sigma = np.where(unknown, 1.0, baseline.row_sigma)
        scaled = baseline.row * weight[..., None] * sigma[:, None, :]
        direction, size, _ = np.linalg.svd(scaled, full_matrices=False)
        removed = 1 - 1 / np.sqrt(1 + size**2)
        acts = size > RANK * np.maximum(size[:, :1], np.finfo(float).tiny)
        return cls(weight, direction, np.where(unknown.any(axis=1, keepdims=True) & acts, 1.0, removed))

    def __call__(self, columns: Array) -> Array:
        """(R·m, q) standard errors: columns (R, m, q), m/s² (rad/s), whitened."""
        x = columns * self.weight[..., None]
        along = np.swapaxes(self.direction, -1, -2) @ x
        x = x - self.direction @ (along * self.removed[..., None])
        return x.reshape(-1, columns.shape[-1])

    @property
    def projected_out(self) -> Array:
        """(R, r) bool, dimensionless: nuisance directions of which nothing is known beforehand."""
        return self.removed == 1


def whitened_design(baseline: Baseline, whiten: Whitener) -> Array:
    """(R·m + k, 5 m + k) standard errors per unit: columns of parameters and of constant nuisances (priors below)."""
    P, k = 5 * baseline.residual.shape[1], len(baseline.constant_sigma)
    design = whiten(np.concatenate([block_columns(baseline.design), baseline.constant], axis=-1))
    prior = np.concatenate([np.zeros((k, P)), np.diag(1 / baseline.constant_sigma)], axis=1)
    return np.concatenate([design, prior])


def parameter_covariance(baseline: Baseline) -> Array:
    """(5 m, 5 m) total covariance, dimensionless; what is not observed carries the plausible range.

    A common turn that nothing observes carries none: the axes are then those of this session's own frame.
    """
    full = whitened_design(baseline, Whitener.of(baseline))
    keep, P = observable_directions(baseline.gauge_free, baseline.parameters), 5 * baseline.residual.shape[1]
    full = np.concatenate([full[:, :P] @ keep, full[:, P:]], axis=1)
    q = keep.shape[1]
    ridge = np.zeros(full.shape[1])
    ridge[:q] = PLAUSIBLE**-2
    scale = np.sqrt((full**2).sum(axis=0) + ridge)
    normal = (full / scale).T @ (full / scale) + np.diag(ridge / scale**2)
    covariance = np.linalg.inv(normal)[:q, :q] / scale[:q, None] / scale[:q]
    return np.asarray(keep @ covariance @ keep.T)


@dataclass(frozen=True, eq=False)
class ParameterChange:
    """How the parameters moved since the history, whitened. P = 5 m parameters."""

    deviation: Array
    """(P,) standard errors: deviation of this session's parameters from the history."""
    inverse_root: Array
    """(P, P) of the deviation's covariance: whitens a dimensionless parameter change."""
    earlier: tuple["EarlierSession", ...] = ()
    """The sessions that the reference is made of."""


@dataclass(frozen=True, eq=False)
class EarlierSession:
    """One session of the history and its part in the reference."""

    residuals: "WhitenedResiduals"
    share: Array
    """(P, P) dimensionless: change of the reference, seen from now, with the parameters found in that session."""


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
        """Of a fitted session, and of its change since the history."""
        whiten = Whitener.of(baseline)
        P, k = 5 * baseline.residual.shape[1], len(baseline.constant_sigma)
        full = whitened_design(baseline, whiten)
        size = np.linalg.norm(full, axis=0)
        scale = np.where(size > 0, size, 1.0)
        left, size, right = np.linalg.svd(full / scale, full_matrices=False)
        kept = size > RANK * size[0]
        response = (right[kept].T / size[kept]) @ left[:, kept].T / scale[:, None]
        data = np.concatenate([whiten(baseline.residual[..., None])[:, 0], np.zeros(k)])
        basis = left[:, kept]
        z = data - basis @ (basis.T @ data)
        if change is not None:
            z = np.concatenate([z, change.deviation])
        freedom = baseline.residual.size - int(whiten.projected_out.sum()) - (int(kept.sum()) - k)
        return cls(baseline, whiten, basis, response[:P], z, change, freedom)

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
        white = self.whitened(columns)
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
