"""The forward model: what the sensors should read, and how that changes with every parameter.

    u = K·(a + b + c·a²),  a = e·n        (analytic alignment paper, equations (12)–(14))

Residuals and Jacobians are taken at the input (divided by K), where noise, biases and stand errors live.
Arrays are indexed (..., R, m); in memory the rows of one sensor lie together, which is what the solver works on.
"""

import numpy as np

from estimator.parameters import SensorParameters
from estimator.session import ACCELEROMETER, Array, CalibrationSession


def projected(axis: Array, vectors: Array) -> Array:
    """a = e·n: axis (..., m, 3) and vectors (R, m, 3), m/s² (rad/s), give (..., R, m) of the same unit."""
    return _by_sensor(axis[..., None], vectors)[..., 0].swapaxes(-1, -2)


def _by_sensor(directions: Array, vectors: Array) -> Array:
    """Vectors (R, m, 3) along the columns of directions (..., m, 3, d): (..., m, R, d), in the vectors' unit."""
    return vectors.swapaxes(0, 1) @ directions


def input_of(p: SensorParameters, n: Array) -> Array:
    """The sensor's input, a + b + c·a²: (..., R, m) for n (R, m, 3), m/s² (rad/s) each."""
    a = projected(p.axis, n)
    return a + p.bias[..., None, :] + p.quadratic[..., None, :] * a * a


def response(p: SensorParameters, n: Array) -> Array:
    """Readings without noise, K·(a + b + c·a²): (..., R, m) reading units for n (R, m, 3), m/s² (rad/s)."""
    return p.scale[..., None, :] * input_of(p, n)


def slope(p: SensorParameters, n: Array) -> Array:
    """Derivative of the input by a, 1 + 2·c·a: (..., R, m) dimensionless for n (R, m, 3), m/s² (rad/s)."""
    return 1.0 + 2.0 * p.quadratic[..., None, :] * projected(p.axis, n)


def jacobian(p: SensorParameters, n: Array, norm: Array) -> Array:
    """Derivative of reading/K by the dimensionless elements of `estimator.parameters`, K of the divisor held.

    n (R, m, 3) of lengths ``norm`` (m,), m/s² (rad/s); the result is (..., R, m, 5) in the same unit.
    """
    along = _by_sensor(np.concatenate([p.axis[..., None], p.axis_tangents], axis=-1), n)
    a, c, size = along[..., 0], p.quadratic[..., None], norm[:, None]
    columns = np.empty((*a.shape, 5))
    columns[..., 0] = a + p.bias[..., None] + c * a * a
    columns[..., 1] = size
    columns[..., 2] = a * a / size
    columns[..., 3:] = (1.0 + 2.0 * c * a)[..., None] * along[..., 1:]
    return columns.swapaxes(-3, -2)


def measured(session: CalibrationSession) -> tuple[Array, Array]:
    """Readings and their standard errors as the model gives them: (R, m) each, reading units (pulses per s).

    The stated nominal offset is taken off; pulse counts become pulses per second, with the quantisation of the count
    (`CalibrationSession.quantisation`) in the standard error.
    """
    readings, errors = session.readings, session.standard_errors
    if any(s.nominal_offset for s in session.sensors):
        readings = readings - np.array([s.nominal_offset or 0.0 for s in session.sensors])
    if session.count_time is None:
        return readings, errors
    gyro = np.array([s.kind != ACCELEROMETER for s in session.sensors])
    period = np.where(gyro, session.count_time, 1.0)
    quantisation = np.where(gyro, session.quantisation, 0.0)
    return readings / period, np.sqrt(errors**2 + quantisation) / period
