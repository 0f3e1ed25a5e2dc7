"""Errors of a host that turns readings into a vector by the nominal numbers, as a matrix and an offset.

Theory
------
Drivers of flight controllers and robots know the nominal scale Kₙ and axis eₙ of each sensor, and correct the vector
that these give. With the reading u, its offset u₀ and the count time T (1 but for pulse gyros) that vector is

    fₙ = Pₙ·(u − u₀)/(T·Kₙ),    Pₙ = (EₙᵀEₙ)⁻¹Eₙᵀ.

The calibrated model u = u₀ + T·K·(a + b + c·a²), a = E·f, without its quadratic term, makes it

    fₙ = A·f + d,    A = Pₙ·diag(K/Kₙ)·E,    d = Pₙ·diag(K/Kₙ)·b,

so that f = S·fₙ − o with S = A⁻¹ and o = S·d takes out every error of scale, axis and bias, for three sensors and for
more. For three sensors along the nominal axes x, y, z, A holds scale factors and misalignments as they are commonly
written. The covariance of S and o follows to first order, δS = −S·δA·S and δo = S·δd + δS·d.
"""

from dataclasses import dataclass

import numpy as np

from estimator.correction import BlockCorrection
from estimator.session import Array, CalibrationSession


@dataclass(frozen=True, eq=False)
class NominalVector:
    """Difference between the vector by the nominal numbers and the true one, for the sensors of one kind."""

    kind: str
    matrix: Array
    """(3, 3) A, dimensionless."""
    offset: Array
    """(3,) d, m/s² (rad/s)."""
    covariance: Array
    """(12, 12) covariance of S row by row and then o; NaN where the noise cannot be estimated."""
    curvature: float
    """Largest |c| of the sensors, s²/m (s/rad): c·a² is what the matrix cannot hold."""

    @property
    def correction(self) -> Array:
        """(3, 3) S, dimensionless."""
        inverse: Array = np.linalg.inv(self.matrix)
        return inverse

    @property
    def bias(self) -> Array:
        """(3,) o, m/s² (rad/s)."""
        bias: Array = self.correction @ self.offset
        return bias

    def corrected(self, vectors: Array) -> Array:
        """f of vectors fₙ (R, 3), m/s² (rad/s): the same shape and unit."""
        return vectors @ self.correction.T - self.bias


def nominal_vectors(session: CalibrationSession, block: BlockCorrection, readings: Array) -> Array:
    """fₙ (R, 3), m/s² (rad/s), of readings (R, m) of the block's sensors, reading units."""
    scale, projection = _nominal(session, block)
    offset = np.array([sensor.offset for sensor in block.sensors])
    period = np.array([sensor.count_time or 1.0 for sensor in block.sensors])
    vectors: Array = (readings - offset) / (period * scale) @ projection.T
    return vectors


def nominal_vector(session: CalibrationSession, block: BlockCorrection) -> NominalVector:
    """The errors of a session's nominal numbers, by the correction of its sensors of one kind.

    Raises
    ------
    numpy.linalg.LinAlgError
        Where the calibrated axes no longer give three directions along the nominal ones.
    """
    scale, projection = _nominal(session, block)
    ratio = np.array([sensor.scale for sensor in block.sensors]) / scale
    axes = np.stack([sensor.axis for sensor in block.sensors])
    bias = np.array([sensor.bias for sensor in block.sensors])
    weighted = projection * ratio
    matrix, offset = weighted @ axes, weighted @ bias
    jacobian = _jacobian(block, projection / scale, weighted, np.linalg.inv(matrix), offset)
    curvature = max(abs(sensor.quadratic) for sensor in block.sensors)
    return NominalVector(block.kind, matrix, offset, jacobian @ block.covariance @ jacobian.T, curvature)


def _nominal(session: CalibrationSession, block: BlockCorrection) -> tuple[Array, Array]:
    """(m,) Kₙ and (3, m) Pₙ of the block's sensors."""
    declared = {sensor.name: sensor for sensor in session.sensors}
    declared_sensors = [declared[sensor.name] for sensor in block.sensors]
    axes = np.stack([sensor.nominal_axis for sensor in declared_sensors])
    return np.array([sensor.nominal_scale for sensor in declared_sensors]), np.linalg.pinv(axes)


def _jacobian(block: BlockCorrection, by_scale: Array, weighted: Array, inverse: Array, offset: Array) -> Array:
    """(12, 5 m) derivatives of S and o by scale, bias, quadratic and the axis' two tangents, sensor after sensor."""
    columns = []
    for i, sensor in enumerate(block.sensors):
        moved = [(np.outer(by_scale[:, i], sensor.axis), by_scale[:, i] * sensor.bias)]
        moved += [(np.zeros((3, 3)), weighted[:, i]), (np.zeros((3, 3)), np.zeros(3))]
        moved += [(np.outer(weighted[:, i], tangent), np.zeros(3)) for tangent in sensor.tangents.T]
        for matrix, shift in moved:
            turned = -inverse @ matrix @ inverse
            columns.append(np.concatenate([turned.ravel(), inverse @ shift + turned @ offset]))
    jacobian: Array = np.stack(columns, axis=1)
    return jacobian
