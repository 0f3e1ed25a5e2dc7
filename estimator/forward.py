"""The forward model: what the sensors should read, and how that changes with every parameter.

    u = K·(a + b + c·a²),  a = e·n        (analytic alignment paper, equations (12)–(14))

Residuals and Jacobians are taken at the input (divided by K), where noise, biases and stand errors live.
"""

import numpy as np

from estimator.arrays import tangents
from estimator.parameters import SensorParameters
from estimator.session import ACCELEROMETER, Array, CalibrationSession


def projected(axis: Array, vectors: Array) -> Array:
    """a = e·n: axis (..., m, 3) and vectors (R, m, 3) give (..., R, m)."""
    return (axis[..., None, :, :] * vectors).sum(axis=-1)


def input_of(p: SensorParameters, n: Array) -> Array:
    """What the sensor integrates, a + b + c·a², at the input: (..., R, m) for n (R, m, 3)."""
    a = projected(p.axis, n)
    return a + p.bias[..., None, :] + p.quadratic[..., None, :] * a * a


def response(p: SensorParameters, n: Array) -> Array:
    """Readings without noise, K·(a + b + c·a²): (..., R, m) for n (R, m, 3)."""
    return p.scale[..., None, :] * input_of(p, n)


def slope(p: SensorParameters, n: Array) -> Array:
    """How the input answers to a change of a, 1 + 2·c·a: (..., R, m)."""
    return 1.0 + 2.0 * p.quadratic[..., None, :] * projected(p.axis, n)


def jacobian(p: SensorParameters, n: Array, norm: Array) -> Array:
    """Derivative of the input by the dimensionless elements: (..., R, m, 5); ``norm`` (m,)."""
    a = projected(p.axis, n)
    c = p.quadratic[..., None, :]
    turned = (tangents(p.axis)[..., None, :, :, :] * n[..., None]).sum(axis=-2)
    columns = np.empty((*a.shape, 5))
    columns[..., 0] = a + p.bias[..., None, :] + c * a * a
    columns[..., 1] = norm
    columns[..., 2] = a * a / norm
    columns[..., 3:] = (1.0 + 2.0 * c * a)[..., None] * turned
    return columns


def measured(session: CalibrationSession) -> tuple[Array, Array]:
    """Readings and their standard errors as the model gives them: (R, m) each.

    The stated nominal offset is taken off; pulse counts become pulses per second, with the quantisation of the count
    (one pulse, uniform) in the standard error.
    """
    offset = np.array([s.nominal_offset or 0.0 for s in session.sensors])
    readings, errors = session.readings - offset, session.standard_errors
    if session.count_time is None:
        return readings, errors
    gyro = np.array([s.kind != ACCELEROMETER for s in session.sensors])
    period = np.where(gyro, session.count_time, 1.0)
    quantisation = np.where(gyro, 1.0 / 12.0, 0.0)
    return readings / period, np.sqrt(errors**2 + quantisation) / period
