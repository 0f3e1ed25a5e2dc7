"""The fitted state of a session in arbitrary orientations, in the terms of the diagnosis."""

from dataclasses import dataclass

import numpy as np

from estimator.applied_vector import EARTH_RATE, gravity
from estimator.calibration.free import accelerometer_rows, check, gyro_biases, solve
from estimator.parameters import SensorParameters
from estimator.session import ACCELEROMETER, Array, CalibrationSession

SHARP = np.radians(0.1)
"""Stated directions are taken as the applied vector when they are known better than this, rad; worse ones are
estimated from the readings, with what is stated as prior."""


@dataclass(frozen=True, eq=False)
class OrientationState:
    """R orientations, m sensors (accelerometers and gyros)."""

    directions: Array
    """(R, 3) unit vectors, block axes."""
    direction_sigma: Array
    """(R,) rad; infinite where the direction is estimated from the readings themselves."""
    parameters: SensorParameters
    variance: Array
    """(R, m) variance of the independent noise at the input, (m/s²)² ((rad/s)²)."""
    felt: bool
    """Whether there are accelerometers, so that gyros' specific force is known."""


def fitted_state(session: CalibrationSession) -> OrientationState:
    """Directions and parameters of an averaged session; ScheduleError where nothing can be estimated."""
    check(session)
    is_gyro = np.array([s.kind != ACCELEROMETER for s in session.sensors])
    rows, m = session.readings.shape
    scale = np.array([s.nominal_scale for s in session.sensors])
    bias, quadratic = np.zeros(m), np.zeros(m)
    axis = np.stack([s.nominal_axis for s in session.sensors])
    variance = np.ones((rows, m))
    directions, sigma = np.zeros((rows, 3)), np.full(rows, np.inf)
    if not is_gyro.all():
        g = gravity(session.site)
        prepared, stated = accelerometer_rows(session, ~is_gyro, g)
        solution = solve(prepared, stated, None)
        state, gain = solution.unknowns, np.exp(solution.unknowns.log_scale)
        bias[~is_gyro] = state.offset * g / gain
        quadratic[~is_gyro] = state.quadratic / g
        axis[~is_gyro] = state.axes
        scale[~is_gyro] = scale[~is_gyro] * gain
        variance[:, ~is_gyro] = (solution.rows.sigma * g / gain) ** 2
        sharp = prepared.prior > SHARP**-2
        directions = np.where(sharp[:, None], prepared.directions, state.directions)
        sigma = np.where(sharp, 1 / np.sqrt(np.where(sharp, prepared.prior, 1.0)), np.inf)
    if is_gyro.any():
        rest = gyro_biases(session, is_gyro)
        bias[is_gyro] = rest.bias
        variance[:, is_gyro] = rest.noise**2 + EARTH_RATE**2 / 3  # one component of the Earth rate, direction unknown
    return OrientationState(
        directions, sigma, SensorParameters(scale, bias, quadratic, axis), variance, not bool(is_gyro.all())
    )
