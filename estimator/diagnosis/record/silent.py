"""Channels that read the same in every row: they take no part in a calibration, and nothing can be diagnosed of them.

Along the axis that a stand turns about, in one run, a sensor that is alive does so too; a dead one does where its input
changes.
"""

import numpy as np

from estimator.applied_vector import stand_geometry
from estimator.calibration.analytic import answers
from estimator.calibration.calibrate import averaged
from estimator.errors import Problem, ScheduleError
from estimator.forward import measured, response
from estimator.parameters import nominal
from estimator.session import TWO_AXIS_STAND, Array, CalibrationSession

LEAST_CHANGE = 0.05
"""Part of gravity (of the Earth's rate) by which the input along the nominal axis must change over the rows for a
constant reading to tell of a dead channel: 3°, more than axes are mounted off."""

LEAST_COUNTS = 2.0
"""Counts by which a reading in whole counts must be expected to change: fewer may round to the same."""

SAME = "has the same reading in every row, so nothing can be estimated from it"


def refuse_silent(session: CalibrationSession) -> None:
    """ScheduleError where a channel of a session on a stand reads the same in every row."""
    names = silent_channels(session)
    if names:
        raise ScheduleError([Problem(name, SAME) for name in names])


def silent_channels(session: CalibrationSession) -> tuple[str, ...]:
    """Sensors of a session on a stand that read the same in every row."""
    if session.programme != TWO_AXIS_STAND:
        return ()
    rows = averaged(session)
    return _named(rows, ~answers(measured(rows)[0]))


def dead_channels(session: CalibrationSession) -> tuple[str, ...]:
    """Sensors of a session on a stand that read the same in every row, although their input changes."""
    if session.programme != TWO_AXIS_STAND:
        return ()
    rows = averaged(session)
    geometry, like = stand_geometry(rows), nominal(rows.sensors)
    expected = np.ptp(response(like, geometry.n), axis=0)
    in_counts = np.all(rows.readings == np.round(rows.readings), axis=0)
    counts = expected * (rows.count_time or 1.0)
    moved = (expected > LEAST_CHANGE * like.scale * geometry.norm) & ~(in_counts & (counts < LEAST_COUNTS))
    return _named(rows, ~answers(measured(rows)[0]) & moved)


def _named(session: CalibrationSession, chosen: Array) -> tuple[str, ...]:
    return tuple(sensor.name for sensor, yes in zip(session.sensors, chosen, strict=True) if yes)
