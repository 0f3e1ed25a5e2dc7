"""The baseline simulation of a session, fitted: what the diagnosis holds against the measurement.

Two programmes give the same picture: on a stand the applied vector is known up to the stand's errors, in arbitrary
orientations it is estimated row by row. In both, a row carries nuisance columns of its own (the β error with its
sigma; the two turns of an unknown direction with an infinite one) and the session carries constant ones.
"""

from dataclasses import dataclass

import numpy as np

from estimator.causes import Setting
from estimator.forward import jacobian
from estimator.parameters import SensorParameters
from estimator.session import Array, CalibrationSession


@dataclass(frozen=True, eq=False)
class Baseline:
    """One fitted session. R rows, m sensors, k constant nuisances, r nuisances a row."""

    session: CalibrationSession
    setting: Setting
    residual: Array
    """(R, m) measured minus simulated, at the input."""
    variance: Array
    """(R, m) of the independent noise at the input."""
    unstated: Array
    """(m,) bool: the noise is estimated from these residuals."""
    constant: Array
    """(R, m, k) effect of each constant nuisance."""
    constant_sigma: Array
    """(k,)"""
    row: Array
    """(R, m, r) effect of each row's own nuisances."""
    row_sigma: Array
    """(R, r); infinite where nothing is known beforehand."""
    expected: Array | None = None
    """(m,) variance that the others of its kind let expect of a sensor, over its own; 0 where they are not asked."""

    @property
    def parameters(self) -> SensorParameters:
        return self.setting.parameters

    @property
    def design(self) -> Array:
        """(R, m, 5) each sensor's own Jacobian by its dimensionless elements."""
        return jacobian(self.parameters, self.setting.n, self.setting.norm)


def spread(own: Array) -> Array:
    """(R, m, 5 m) from each sensor's own columns (R, m, 5)."""
    rows, m, width = own.shape
    full = np.zeros((rows, m, m, width))
    full[:, np.arange(m), np.arange(m), :] = own
    return full.reshape(rows, m, m * width)
