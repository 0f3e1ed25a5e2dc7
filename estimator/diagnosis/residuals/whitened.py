"""What is left of a session after the baseline, whitened: where causes leave their traces.

Theory
------
Residuals of one row share the row's nuisances: D + H S H' with D diagonal. `Whitener` multiplies by the inverse root
(D in each sensor's own sigma, then shrinking the nuisance directions by 1/√(1 + s²), to zero where s is infinite).
Constant nuisances enter as columns with prior rows. Everything that the baseline can absorb is an orthonormal basis;
what a signature leaves outside it is its trace, whose norm is the effect's strength in standard errors.

With history, rows are appended: the whitened deviation of the parameters from the history, and how each cause would
have moved them. A fit's left-over and its parameters are independent, so both kinds of rows stand side by side.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from estimator.diagnosis.residuals.baseline import Baseline, spread
from estimator.diagnosis.residuals.gauge import comparable_directions
from estimator.parameters import PLAUSIBLE
from estimator.session import Array

NOTHING = 1e-9
"""Relative singular value below which a direction of the baseline is no direction."""


@dataclass(frozen=True, eq=False)
class Whitener:
    """Inverse root of the noise covariance of every row."""

    weight: Array
    """(R, m) inverse sigma of the independent noise."""
    direction: Array
    """(R, m, r) orthonormal nuisance directions in units of the independent noise."""
    removed: Array
    """(R, r) share of each direction that is taken away, 1 − 1/√(1 + s²)."""

    @classmethod
    def of(cls, baseline: Baseline) -> "Whitener":
        weight = 1.0 / np.sqrt(baseline.variance)
        open_ended = np.isinf(baseline.row_sigma)
        sigma = np.where(open_ended, 1.0, baseline.row_sigma)
        scaled = baseline.row * weight[..., None] * sigma[:, None, :]
        direction, size, _ = np.linalg.svd(scaled, full_matrices=False)
        removed = 1 - 1 / np.sqrt(1 + size**2)
        acts = size > NOTHING * np.maximum(size[:, :1], np.finfo(float).tiny)
        return cls(weight, direction, np.where(open_ended.any(axis=1, keepdims=True) & acts, 1.0, removed))

    def __call__(self, columns: Array) -> Array:
        """(R, m, q) columns whitened and laid out as (R·m, q)."""
        x = columns * self.weight[..., None]
        along = np.swapaxes(self.direction, -1, -2) @ x
        x = x - self.direction @ (along * self.removed[..., None])
        return x.reshape(-1, columns.shape[-1])


def whitened_design(baseline: Baseline, whiten: Whitener) -> Array:
    """(R·m + k, 5 m + k) columns of the parameters and the constant nuisances, the nuisances' priors below."""
    P, k = 5 * baseline.residual.shape[1], len(baseline.constant_sigma)
    design = whiten(np.concatenate([spread(baseline.design), baseline.constant], axis=-1))
    prior = np.concatenate([np.zeros((k, P)), np.diag(1 / baseline.constant_sigma)], axis=1)
    return np.concatenate([design, prior])


def parameter_covariance(baseline: Baseline) -> Array:
    """(5 m, 5 m) total covariance, dimensionless; what is not observed carries the plausible range.

    A common turn that nothing observes carries none: the axes are then those of this session's own frame.
    """
    full = whitened_design(baseline, Whitener.of(baseline))
    keep, P = comparable_directions(baseline), 5 * baseline.residual.shape[1]
    full = np.concatenate([full[:, :P] @ keep, full[:, P:]], axis=1)
    q = keep.shape[1]
    ridge = np.zeros(full.shape[1])
    ridge[:q] = PLAUSIBLE**-2
    scale = np.sqrt((full**2).sum(axis=0) + ridge)
    normal = (full / scale).T @ (full / scale) + np.diag(ridge / scale**2)
    covariance = np.linalg.inv(normal)[:q, :q] / scale[:q, None] / scale[:q]
    return np.asarray(keep @ covariance @ keep.T)


@dataclass(frozen=True, eq=False)
class Between:
    """What moved since the history, whitened. P = 5 m parameters."""

    deviation: Array
    """(P,) whitened deviation of this session's parameters from the history."""
    response: Array
    """(P, P) whitens a parameter change."""
    past: tuple["Past", ...] = ()
    """The sessions that the reference is made of."""


@dataclass(frozen=True, eq=False)
class Past:
    """An earlier session, and what it is to the reference."""

    evidence: "Evidence"
    weight: Array
    """(P, P) change of the reference, seen from now, with the parameters found in that session."""


@dataclass(frozen=True, eq=False)
class Evidence:
    """Whitened left-overs of one session. Data rows: R·m readings, k priors, then P parameters with history."""

    baseline: Baseline
    whiten: Whitener
    basis: Array
    """(R·m + k, p) orthonormal: what the baseline and the findings so far absorb."""
    absorb: Array
    """(5 m, R·m + k) the parameters' answer to a whitened change of the readings."""
    z: Array
    """(R·m + k [+ P],) whitened left-over."""
    between: Between | None
    freedom: int
    """Degrees of freedom of the left-over readings."""

    @classmethod
    def of(cls, baseline: Baseline, between: Between | None = None) -> "Evidence":
        whiten = Whitener.of(baseline)
        P, k = 5 * baseline.residual.shape[1], len(baseline.constant_sigma)
        full = whitened_design(baseline, whiten)
        size = np.linalg.norm(full, axis=0)
        scale = np.where(size > 0, size, 1.0)
        left, size, right = np.linalg.svd(full / scale, full_matrices=False)
        kept = size > NOTHING * size[0]
        absorb = (right[kept].T / size[kept]) @ left[:, kept].T / scale[:, None]
        data = np.concatenate([whiten(baseline.residual[..., None])[:, 0], np.zeros(k)])
        basis = left[:, kept]
        z = data - basis @ (basis.T @ data)
        open_rows = int((whiten.removed == 1).sum())
        if between is not None:
            z = np.concatenate([z, between.deviation])
        freedom = baseline.residual.size - open_rows - (int(kept.sum()) - k)
        return cls(baseline, whiten, basis, absorb[:P], z, between, freedom)

    @cached_property
    def spare(self) -> Array:
        """(R·m + k,) share of every row's energy that neither directions nor the baseline take from the noise."""
        known = np.ones(self.readings)
        taken = (self.whiten.direction**2 * (self.whiten.removed == 1)[:, None, :]).sum(axis=-1)
        known[: taken.size] -= taken.ravel()
        return known - (self.basis**2).sum(axis=1)

    @property
    def readings(self) -> int:
        """Number of reading and prior rows."""
        return self.basis.shape[0]

    def raw(self, columns: Array) -> Array:
        """(R·m + k, q) whitened signature before the baseline absorbs its share."""
        white = self.whiten(columns)
        return np.concatenate([white, np.zeros((self.readings - len(white), white.shape[1]))])

    def trace(self, columns: Array, before: Array | float | None = None) -> Array:
        """What a signature (R, m, q) leaves: (data rows, q).

        What the baseline absorbs of it shows as a move of the parameters, unless it was there ``before``: (P, q) what
        the history absorbed of it; 0 of what is new, None where it absorbed as much as now.
        """
        white = self.raw(columns)
        inside = white - self.basis @ (self.basis.T @ white)
        if self.between is None:
            return inside
        if before is None:
            return np.concatenate([inside, np.zeros((len(self.between.deviation), white.shape[1]))])
        return np.concatenate([inside, self.between.response @ (self.absorb @ white - before)])

    @cached_property
    def owner(self) -> Array:
        """(data rows,) index of the sensor a row belongs to; −1 for priors."""
        R, m = self.baseline.residual.shape
        owner = np.full(len(self.z), -1)
        owner[: R * m] = np.tile(np.arange(m), R)
        if self.between is not None:
            owner[self.readings :] = np.repeat(np.arange(m), 5)
        return owner
