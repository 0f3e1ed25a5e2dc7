"""The inverse root of the noise covariance of every row, D + H S H' with D diagonal: what whitens a session.

Rows are taken in each sensor's own sigma, then the row's nuisance directions are shrunk by 1/√(1 + s²), to zero where
s is infinite.
"""

from dataclasses import dataclass

import numpy as np

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
    def of(cls, variance: Array, row: Array, row_sigma: Array) -> "Whitener":
        """From the noise and the nuisances of every row, as in `Baseline`."""
        weight = 1.0 / np.sqrt(variance)
        unknown = np.isinf(row_sigma)
        sigma = np.where(unknown, 1.0, row_sigma)
        scaled = row * weight[..., None] * sigma[:, None, :]
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

    def transposed(self, rows: Array) -> Array:
        """(P, R, m) per m/s² (rad/s): rows (P, R, m) that act on what is whitened, acting on what is not."""
        along = rows[:, :, None, :] @ self.direction * self.removed[:, None, :]
        return (rows - (along @ np.swapaxes(self.direction, -1, -2))[:, :, 0]) * self.weight

    @property
    def projected_out(self) -> Array:
        """(R, r) bool, dimensionless: nuisance directions of which nothing is known beforehand."""
        return self.removed == 1
