"""The fitted baseline simulation of a session: what the diagnosis holds against the measurement.

Two programmes give the same picture: on a stand the applied vector is known up to the stand's errors, in arbitrary
orientations it is estimated row by row. In both, a row carries nuisance columns of its own (the β error with its
sigma; the two turns of an unknown direction with an infinite one) and the session carries constant ones.

Gauge freedom: in arbitrary orientations all axes may turn together, and every applied vector with them, unseen.

A session is whitened by the inverse root of the noise covariance of every row, D + H S H' with D diagonal: rows are
taken in each sensor's own sigma, then the row's nuisance directions are shrunk by 1/√(1 + s²), to zero where s is
infinite.
"""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from estimator.arrays import crossed
from estimator.causes.contract import Setting
from estimator.forward import jacobian
from estimator.least_squares import decomposed
from estimator.parameters import PLAUSIBLE, SensorParameters
from estimator.session import ACCELEROMETER, Array, CalibrationSession

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
        """The whitener of the noise and the nuisances of every row, as in `Baseline`."""
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


def observable_directions(free: Array, parameters: SensorParameters) -> Array:
    """(P, q) orthonormal, dimensionless: every direction of the P = 5 m parameters but a common turn of free axes.

    ``free`` (m,) bool, `Baseline.gauge_free`.
    """
    if not free.any():
        return np.eye(5 * len(free))
    turn = turn_response(parameters) * np.repeat(free, 5)[:, None]
    directions, _, _ = np.linalg.svd(turn)
    return np.asarray(directions[:, 3:])


def turn_response(parameters: SensorParameters) -> Array:
    """(P, 3) per rad: change of all P = 5 m parameters with a small rotation of the block; leading axes are free."""
    response = np.zeros((*parameters.scale.shape, 5, 3))
    response[..., 3:, :] = axis_response(parameters)
    return response.reshape(*parameters.scale.shape[:-1], -1, 3)


def axis_response(parameters: SensorParameters) -> Array:
    """(m, 2, 3) rad per rad: tangent components of every axis' response k×e to a small rotation vector k."""
    return np.asarray(np.swapaxes(parameters.axis_tangents, -1, -2) @ crossed(parameters.axis))


@dataclass(frozen=True, eq=False)
class Absorption:
    """The part of whitened readings that the baseline absorbs. N = R·m + k rows, P = 5 m parameters."""

    basis: Array
    """(N, p) orthonormal: what the baseline absorbs."""
    response: Array
    """(P, N) dimensionless: change of the parameters with a whitened change of the readings (pseudo-inverse)."""

    @classmethod
    def of(cls, design: Array, P: int) -> "Absorption":
        """The absorption of a whitened design (N, P + k), standard errors per unit."""
        basis, response = decomposed(design, RANK)
        return cls(basis, response[:P])


@dataclass(frozen=True, eq=False)
class Baseline:
    """One fitted session. R rows, m sensors, k constant nuisances, r nuisances a row; inputs in m/s² (rad/s)."""

    session: CalibrationSession
    setting: Setting
    residual: Array
    """(R, m) measured minus simulated, at the input, m/s² (rad/s)."""
    variance: Array
    """(R, m) variance of the independent noise at the input, (m/s²)² ((rad/s)²)."""
    unstated: Array
    """(m,) bool: the noise is estimated from these residuals."""
    constant: Array
    """(R, m, k) input change per unit of each constant nuisance, m/s² (rad/s) per rad."""
    constant_sigma: Array
    """(k,) rad."""
    row: Array
    """(R, m, r) input change per unit of each row's own nuisances, m/s² (rad/s) per rad."""
    row_sigma: Array
    """(R, r) rad; infinite where nothing is known beforehand."""
    expected_ratio: Array | None = None
    """(m,) variance that the other sensors of its kind suggest, relative to its own; 0 where they are not asked."""
    turn: Array = field(default_factory=lambda: np.zeros(3))
    """(3,) rotation vector, rad, of an earlier session: it was turned by this into the frame of the one diagnosed."""
    sits_otherwise: bool = False
    """Whether the block sat differently in the latest earlier session, so that its frame shows no common turn."""
    course: Array | None = None
    """(R, m) an effect beside which it was fitted, m/s² (rad/s); it is in the residuals. None where there is none."""
    unsettled: Array | None = None
    """(m, 5) dimensionless: one sigma by which parameters may lie off those of the unit's settled sessions."""

    @property
    def parameters(self) -> SensorParameters:
        """(m,) sensors: the fitted parameters."""
        return self.setting.parameters

    @property
    def design(self) -> Array:
        """(R, m, 5) each sensor's own Jacobian by its dimensionless elements, m/s² (rad/s)."""
        return jacobian(self.parameters, self.setting.n, self.setting.norm)

    @property
    def gauge_free(self) -> Array:
        """(m,) bool, dimensionless: sensors whose axes may turn together unseen, because no applied vector is known."""
        unseen = self.row_sigma.size > 0 and bool(np.isinf(self.row_sigma).all())
        return np.array([unseen and kind == ACCELEROMETER for kind in self.setting.kinds])

    @cached_property
    def whiten(self) -> Whitener:
        """Inverse root of the noise covariance of every row."""
        return Whitener.of(self.variance, self.row, self.row_sigma)

    @cached_property
    def whitened_design(self) -> Array:
        """(R·m + k, 5 m + k) standard errors per unit: of parameters and constant nuisances (their priors below)."""
        P, k = 5 * self.residual.shape[1], len(self.constant_sigma)
        design = self.whiten(np.concatenate([block_columns(self.design), self.constant], axis=-1))
        prior = np.concatenate([np.zeros((k, P)), np.diag(1 / self.constant_sigma)], axis=1)
        return np.concatenate([design, prior])

    @cached_property
    def absorption(self) -> Absorption:
        """The part of the readings that the fit absorbs."""
        return Absorption.of(self.whitened_design, 5 * self.residual.shape[1])

    @cached_property
    def covariance(self) -> Array:
        """(5 m, 5 m) total, of the parameters, dimensionless; what is not observed carries the plausible range.

        A common turn that nothing observes carries none: the axes are then those of this session's own frame.
        """
        keep, P = observable_directions(self.gauge_free, self.parameters), 5 * self.residual.shape[1]
        full = np.concatenate([self.whitened_design[:, :P] @ keep, self.whitened_design[:, P:]], axis=1)
        q = keep.shape[1]
        ridge = np.zeros(full.shape[1])
        ridge[:q] = PLAUSIBLE**-2
        scale = np.sqrt((full**2).sum(axis=0) + ridge)
        normal = (full / scale).T @ (full / scale) + np.diag(ridge / scale**2)
        covariance = np.linalg.inv(normal)[:q, :q] / scale[:q, None] / scale[:q]
        return np.asarray(keep @ covariance @ keep.T)

    @property
    def covariance_between(self) -> Array:
        """(5 m, 5 m) `covariance` with the spread of the parameters about those of settled sessions, dimensionless."""
        return self.covariance if self.unsettled is None else self.covariance + np.diag(self.unsettled.ravel() ** 2)


def block_columns(by_sensor: Array) -> Array:
    """Each sensor's own columns (R, m, 5), m/s² (rad/s), as (R, m, 5 m) columns of the parameters of all."""
    rows, m, width = by_sensor.shape
    full = np.zeros((rows, m, m, width))
    full[:, np.arange(m), np.arange(m), :] = by_sensor
    return full.reshape(rows, m, m * width)
