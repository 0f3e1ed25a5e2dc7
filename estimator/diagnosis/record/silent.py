"""Channels that read the same in every row: they take no part in a calibration, and nothing is diagnosed of them."""

import numpy as np

from estimator.calibration.analytic import answers
from estimator.calibration.calibrate import averaged
from estimator.errors import Problem, ScheduleError
from estimator.forward import measured
from estimator.session import TWO_AXIS_STAND, Array, CalibrationSession

SAME = "has the same reading in every row, so nothing can be estimated from it"
MOSTLY = "stands still over most of the rows, so nothing can be estimated from it: repeat the session, or leave it out"


def refuse_silent(session: CalibrationSession) -> None:
    """ScheduleError where a channel of a session on a stand reads the same in every row."""
    constant, names = silent_channels(session), [sensor.name for sensor in session.sensors]
    stopped = [names[i] for i in np.flatnonzero(np.isinf(session.standard_errors).all(axis=0))]
    problems = [Problem(name, SAME) for name in constant]
    problems += [Problem(name, MOSTLY) for name in stopped if name not in constant]
    if problems:
        raise ScheduleError(problems)


def silent_channels(session: CalibrationSession) -> tuple[str, ...]:
    """Sensors of a session on a stand that read the same in every row."""
    if session.programme != TWO_AXIS_STAND:
        return ()
    rows = averaged(session)
    return _named(rows, ~answers(measured(rows)[0]))


def _named(session: CalibrationSession, chosen: Array) -> tuple[str, ...]:
    return tuple(sensor.name for sensor, yes in zip(session.sensors, chosen, strict=True) if yes)
