"""Gyros of a log whose noise is known beforehand: with a log without noise, the inverse information at the truth."""

from dataclasses import replace

import numpy as np

from estimator.applied_vector import gravity
from estimator.calibration.free import accelerometer_rows, solve
from estimator.calibration.free.by_hand import HandGyros, common, directions_of, knowledge, log_of
from estimator.calibration.free.model import linearise
from estimator.calibration.free.schedule import classified
from estimator.hand_turns import TurnedGyros, calibrate_turned
from estimator.session import CalibrationSession


def known_noise(session: CalibrationSession, sigma: float) -> HandGyros:
    """The gyros of averaged rows with their log; ``sigma`` of a gyro's sample, rad/s, nominal scales 1."""
    live, _, gyro = classified(session)
    rows, stated = accelerometer_rows(session, live, gravity(session.site))
    solution = solve(rows, stated, quadratic=False)
    linear = linearise(solution.rows, solution.unknowns)
    assert session.rests is not None
    log = log_of(session, session.rests, solution, live, gyro)
    of_rest = np.repeat(sigma / np.sqrt(log.stop - log.start)[:, None], gyro.sum(), axis=1)
    log = replace(log, noise=np.full(gyro.sum(), sigma**2), rest_sigma=of_rest)
    found = calibrate_turned(log, directions_of(solution, linear, len(log.start)))
    assert isinstance(found, TurnedGyros)
    return knowledge(found, np.ones(gyro.sum()), common(solution, linear, live, session), session)
