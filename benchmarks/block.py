"""The block that P1 and P2 calibrate: six accelerometers on a cone, 24 positions in each of two runs."""

import numpy as np

from estimator import CalibrationSession, Sensor, Site, Stand, StandErrors
from estimator.results import ARCSEC
from estimator.session import ACCELEROMETER
from estimator.simulate import cone, scattered, simulate, stand_schedule

POSITIONS, SENSORS, GRAVITY = 24, 6, 9.81532


def sessions(count: int) -> list[CalibrationSession]:
    """Simulated sessions of one unit on the stand of the published simulation."""
    rng = np.random.default_rng(1)
    axes = cone(SENSORS, np.arccos(1 / np.sqrt(3)))
    block = tuple(Sensor(f"A{i + 1}", ACCELEROMETER, axes[i], 0.12, "V", 6.5e-5) for i in range(SENSORS))
    sigma = StandErrors(theta_x=ARCSEC / 3, theta_y=ARCSEC / 3, alpha=ARCSEC, beta=ARCSEC)
    stand = Stand("ODG-1", alpha=np.radians(40.0), sigma=sigma)
    schedule = stand_schedule(block, stand, Site(gravity=GRAVITY), POSITIONS)
    truth = scattered(block, np.full(SENSORS, GRAVITY), rng)
    return [simulate(schedule, truth, rng, noise=3e-6) for _ in range(count)]
