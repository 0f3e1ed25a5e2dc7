"""A change of a sensor in people's units, as the dimensionless step that `SensorParameters.stepped` takes."""

from dataclasses import dataclass

import numpy as np

from estimator.applied_vector import EARTH_RATE
from estimator.results import ARCSEC
from estimator.session import ACCELEROMETER, Array

ELEMENT = {"scale": 0, "bias": 1, "quadratic": 2, "axis": 3}
"""Place in the step of five; an axis turns along its first tangent."""
MICRO = 1e-6
"""ppm, µg and µg/g² in parts of one."""
DEGREE_PER_HOUR = np.pi / 180 / 3600 / EARTH_RATE
"""One °/h as a fraction of the Earth's rate."""


@dataclass(frozen=True)
class Change:
    """How much one parameter of one sensor moves: ppm, µg (gyro: °/h), µg/g², arcsec."""

    sensor: int
    """Counted from 0."""
    parameter: str
    amount: float


def step_of(changes: tuple[Change, ...], sensors: int, kind: str) -> Array:
    """(m, 5) the changes added up, dimensionless."""
    bias = MICRO if kind == ACCELEROMETER else DEGREE_PER_HOUR
    factor = {"scale": MICRO, "bias": bias, "quadratic": MICRO, "axis": ARCSEC}
    step = np.zeros((sensors, 5))
    for change in changes:
        step[change.sensor, ELEMENT[change.parameter]] += change.amount * factor[change.parameter]
    return step
