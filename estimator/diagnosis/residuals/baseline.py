"""The fitted baseline simulation of a session: what the diagnosis holds against the measurement.

Two programmes give the same picture: on a stand the applied vector is known up to the stand's errors, in arbitrary
orientations it is estimated row by row. In both, a row carries nuisance columns of its own (the β error with its
sigma; the two turns of an unknown direction with an infinite one) and the session carries constant ones.
"""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from estimator.causes.contract import Setting
from estimator.diagnosis.residuals.gauge import observable_directions
from estimator.diagnosis.residuals.whitener import RANK, Whitener
from estimator.forward import jacobian
from estimator.least_squares import decomposed
from estimator.parameters import PLAUSIBLE, SensorParameters
from estimator.session import ACCELEROMETER, Array, CalibrationSession


@dataclass(frozen=True, eq=False)
class Absorption:
    """What the baseline takes of whitened readings. N = R·m + k rows, P = 5 m parameters."""

    basis: Array
    """(N, p) orthonormal: what the baseline absorbs."""
    response: Array
    """(P, N) dimensionless: change of the parameters with a whitened change of the readings (pseudo-inverse)."""

    @classmethod
    def of(cls, design: Array, P: int) -> "Absorption":
        """Of a whitened design (N, P + k), standard errors per unit."""
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
    """(R, m) of the independent noise at the input, (m/s²)² ((rad/s)²)."""
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
    """Whether the block sat otherwise than in the latest earlier session, so that its frame tells of no common turn."""

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
        """What the fit takes of the readings."""
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


def block_columns(own: Array) -> Array:
    """Each sensor's own columns (R, m, 5), m/s² (rad/s), as (R, m, 5 m) columns of the parameters of all."""
    rows, m, width = own.shape
    full = np.zeros((rows, m, m, width))
    full[:, np.arange(m), np.arange(m), :] = own
    return full.reshape(rows, m, m * width)
