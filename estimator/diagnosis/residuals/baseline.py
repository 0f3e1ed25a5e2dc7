"""The fitted baseline simulation of a session: what the diagnosis holds against the measurement.

Two programmes give the same picture: on a stand the applied vector is known up to the stand's errors, in arbitrary
orientations it is estimated row by row. In both, a row carries nuisance columns of its own (the β error with its
sigma; the two turns of an unknown direction with an infinite one) and the session carries constant ones.
"""

from dataclasses import dataclass, field

import numpy as np

from estimator.causes.contract import Setting
from estimator.forward import jacobian
from estimator.parameters import SensorParameters
from estimator.session import ACCELEROMETER, Array, CalibrationSession


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


def block_columns(own: Array) -> Array:
    """Each sensor's own columns (R, m, 5), m/s² (rad/s), as (R, m, 5 m) columns of the parameters of all."""
    rows, m, width = own.shape
    full = np.zeros((rows, m, m, width))
    full[:, np.arange(m), np.arange(m), :] = own
    return full.reshape(rows, m, m * width)
