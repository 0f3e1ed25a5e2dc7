"""Sessions in which effects are hidden: time and temperature wander, positions come in no order."""

from dataclasses import replace

import numpy as np

from estimator import CalibrationSession
from estimator.applied_vector import EARTH_RATE
from estimator.parameters import SensorParameters
from estimator.session import ACCELEROMETER
from estimator.simulate import scattered
from tests.builders import GRAVITY
from tests.estimator.calibration.cases import at_rows


def wandering(schedule: CalibrationSession, seed: int = 2) -> CalibrationSession:
    """Positions of every run in a random order, uneven times, a temperature that follows neither."""
    rng = np.random.default_rng(seed)
    runs = schedule.flipped
    order = np.concatenate([rng.permutation(np.flatnonzero(runs == flipped)) for flipped in (False, True)])
    shuffled = at_rows(schedule, order)
    time = np.cumsum(rng.uniform(80, 160, len(order))) - 80.0
    turn = 2 * np.pi * time / time[-1]
    swing = np.random.default_rng(seed + 1).gamma(1.0, 1e-2, (len(order), 1))
    return replace(
        shuffled,
        time=time,
        temperature=21 + 2 * np.sin(2.3 * turn) + np.cos(3.7 * turn),
        vibration=np.repeat(swing, len(schedule.sensors), axis=1),
    )


def truth_of(session: CalibrationSession, seed: int = 3) -> SensorParameters:
    """True parameters scattered about the nominal ones."""
    norm = np.array([GRAVITY if s.kind == ACCELEROMETER else EARTH_RATE for s in session.sensors])
    return scattered(session.sensors, norm, np.random.default_rng(seed), axis=1e-4)
