"""The noise of the blocks that `imu-health simulate` measures, in reading units."""

import numpy as np

from estimator.session import ACCELEROMETER, GYROSCOPE, Array, CalibrationSession
from service.demo.blocks import MICRO_G
from service.demo.other_programmes import RATE_NOISE

USUAL_NOISE = {ACCELEROMETER: 2.5, GYROSCOPE: 0.3}
"""One sigma of an averaged reading, unless another is asked for: µg; pulses."""


def noise_of(schedule: CalibrationSession, noise: float) -> Array:
    """(m,) one sigma of an averaged reading, reading units: ``noise`` is µg, of a block of pulse gyros pulses."""
    found = [MICRO_G * noise * s.nominal_scale if s.kind == ACCELEROMETER else RATE_NOISE for s in schedule.sensors]
    return np.array(found) if schedule.count_time is None else np.full(len(found), noise)
