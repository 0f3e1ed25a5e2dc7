"""The motion that a recording shows beside its redundant sensors: the angular rate, from the gyros among its columns.

Rows of gyros are taken by the reference calibration where it knows them, else as their maker describes them: a few per
cent are enough, because the rate serves to bound what lever arms do, not to navigate.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimator.results import Calibration
from estimator.session import GYROSCOPE, Array, Sensor

FEWEST = 3
"""Gyros that show a rate in every direction."""


@dataclass(frozen=True, eq=False)
class Gyros:
    """g gyros that run beside the block."""

    column: NDArray[np.intp]
    """(g,) place of each among the recording's sensors."""
    zero: Array
    """(g,) reading at rest, reading units."""
    inverse: Array
    """(3, g) rad/s per reading unit."""

    def rates(self, readings: Array) -> Array:
        """(R, 3) angular rate, rad/s, block axes, from readings (R, n) of all sensors of the recording."""
        return np.asarray((readings[:, self.column] - self.zero) @ self.inverse.T)


def gyros_of(sensors: Sequence[Sensor], calibration: Calibration) -> Gyros | None:
    """The gyros of a recording; None where they do not show a rate in every direction."""
    gyros = [(k, s) for k, s in enumerate(sensors) if s.kind == GYROSCOPE]
    if len(gyros) < FEWEST:
        return None
    described = [_described(s, calibration) for _, s in gyros]
    slope = np.array([scale * axis for scale, _, axis in described])
    return Gyros(
        column=np.array([k for k, _ in gyros]),
        zero=np.array([zero for _, zero, _ in described]),
        inverse=np.linalg.pinv(slope),
    )


def _described(sensor: Sensor, calibration: Calibration) -> tuple[float, float, Array]:
    """Reading units per rad/s, reading at rest, axis (3,): calibrated, or nominal."""
    offset = sensor.nominal_offset or 0.0
    for known in calibration.sensors:
        if known.name == sensor.name and known.kind == GYROSCOPE and known.axis is not None and known.scale.value:
            return known.scale.value, offset + known.scale.value * (known.bias.value or 0.0), known.axis
    return sensor.nominal_scale, offset, sensor.nominal_axis
