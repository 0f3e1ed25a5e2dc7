"""Coarse alignment from the means of all stops: attitude at the start, and what the sensors' biases roughly are.

In the table's axes a mean is the same at every stop but for the block's zero, which turns with the table: for the
horizontal rates and specific forces w_k at table angle θ_k, w_k = R(θ_k)ᵀ·h + b, four unknowns, two equations a stop.
The heading follows from h of the rates, which points north, free of the gyros' biases where stops differ.
"""

from dataclasses import dataclass

import numpy as np

from estimator.alignment.positions import Stop
from estimator.alignment.strapdown import BlockMotion
from estimator.arrays import unit
from estimator.errors import ScheduleError, problem_at
from estimator.least_squares import least_squares
from estimator.message import say
from estimator.session import Array

MOST_HEADING = np.radians(10.0)
"""rad, one sigma of the coarse heading that the filter's linear model can start from: the filter's own prior of φ_U.
Beyond it sin φ is no longer φ to a per cent."""


@dataclass(frozen=True, eq=False)
class Coarse:
    """Starting values of the filter."""

    attitude: Array
    """(3, 3) C̃ at the first row, block → east-north-up, dimensionless."""
    gyro_bias: Array
    """(3,) rad/s, the third 0."""
    accelerometer_bias: Array
    """(3,) m/s², the third 0."""


def coarse(stationary: list[Stop], motion: BlockMotion, gyro_noise: Array) -> Coarse:
    """The start of the fine alignment.

    Parameters
    ----------
    stationary : the stops, two different angles at least.
    motion : as the sensors say.
    gyro_noise : (3, 3) density, (rad/s)²/Hz.

    Raises
    ------
    ScheduleError : the gyros do not tell the Earth's rotation from their noise.
    """
    angles = np.array([stop.angle for stop in stationary])
    rate = np.array([motion.rates[stop.first : stop.last].mean(axis=0) for stop in stationary])
    force = np.array([motion.forces[stop.first : stop.last].mean(axis=0) for stop in stationary])
    design = turning_design(angles)
    north, gyro_bias, inverse = _solved(design, rate)
    _, accelerometer_bias, _ = _solved(design, force)
    shortest = min(stop.last - stop.first for stop in stationary) * motion.row
    _require_heading(north, inverse, gyro_noise, shortest)
    up = unit(force[0] - accelerometer_bias)
    east = unit(np.cross(rate[0] - gyro_bias, up))
    return Coarse(np.stack([east, np.cross(up, east), up]), gyro_bias, accelerometer_bias)


def turning_design(angles: Array) -> Array:
    """(2 n, 4) matrix, dimensionless, of (h_x, h_y, b_x, b_y) for the horizontal components at angles (n,), rad."""
    cos, sin, zero, ones = np.cos(angles), np.sin(angles), 0 * angles, 0 * angles + 1
    x = np.stack([cos, sin, ones, zero], axis=1)
    y = np.stack([-sin, cos, zero, ones], axis=1)
    return np.stack([x, y], axis=1).reshape(-1, 4)


def _solved(design: Array, means: Array) -> tuple[Array, Array, Array]:
    """h (2,), the biases (3,) and (DᵀD)⁻¹ (4, 4) from the design (2 n, 4) and stops' means (n, 3), m/s² or rad/s."""
    fit = least_squares(design, means[:, :2].ravel())
    return fit.value[:2], np.append(fit.value[2:], 0.0), fit.covariance


def _require_heading(north: Array, inverse: Array, density: Array, shortest: float) -> None:
    """ScheduleError where h, ``north`` (2,) rad/s, is no better known than `MOST_HEADING` of itself.

    inverse : (4, 4) dimensionless; density : (3, 3), (rad/s)²/Hz; shortest : s of the shortest stop.
    """
    spread = float(np.sqrt(np.trace(density[:2, :2]) / 2 / shortest * inverse[0, 0]))
    size = float(np.hypot(*north))
    if spread > MOST_HEADING * size:
        hours = 180 / np.pi * 3600
        parts = {"size": f"{size * hours:.2g}", "spread": f"{spread * hours:.2g}"}
        message = say("the gyros read {size} ± {spread} °/h of the Earth's horizontal rotation", **parts)
        advice = "rest longer at each angle, or use less noisy gyros"
        raise ScheduleError(
            [problem_at("table", "{message}: too uncertain for a heading; {advice}", message=message, advice=advice)]
        )
