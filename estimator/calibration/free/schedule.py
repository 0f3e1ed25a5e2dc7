"""Checks whether rows in unknown orientations can calibrate anything, and which sensors."""

import numpy as np
from numpy.typing import NDArray

from estimator.applied_vector import gravity
from estimator.calibration.analytic import answers
from estimator.errors import Problem, ScheduleError, problem_at
from estimator.forward import measured
from estimator.message import joined, say
from estimator.session import ACCELEROMETER, CalibrationSession
from estimator.wording import few

Mask = NDArray[np.bool_]

FEWEST = 4
"""Orientations below which nothing at all can be estimated: a sphere needs four points."""

LEAST_TURN = 0.05
"""g; rows whose readings vary less than this show one orientation: 3°, more than a block rocks where it lies."""

LEAST_ANSWER = 1e-3
"""Part of the liveliest accelerometer's variation below which another one does not answer at all: noise may vary a dead
one so much, while a live one shows a good part of it in any set of turns."""

FLATTEST = 0.05
"""Ratio of the nominal axes' singular values below which they lie in one plane, to 3°: the errors of readings
would reach a vector twentyfold."""

GENERIC = 9
"""Unlabelled orientations that determine scale, bias and axes of any block: an ellipsoid has nine parameters."""


def check(session: CalibrationSession) -> None:
    """ScheduleError unless something can be estimated."""
    classified(session)


def classified(session: CalibrationSession) -> tuple[Mask, Mask, Mask]:
    """Masks (m,) of accelerometers that respond to turns, accelerometers that do not, and gyros.

    Raises
    ------
    ScheduleError
        The accelerometers cannot be calibrated from these rows at all.
    """
    gyro = np.array([s.kind != ACCELEROMETER for s in session.sensors])
    R = len(session.readings)
    if gyro.all():
        return np.zeros_like(gyro), np.zeros_like(gyro), gyro
    if R < FEWEST:
        raise ScheduleError(
            [
                problem_at(
                    "table", "{problem} to estimate anything; {advice}", problem=few(R, "orientation"), advice=advice(R)
                )
            ]
        )
    unit = gravity(session.site) * np.array([s.nominal_scale for s in session.sensors])
    readings = measured(session)[0]
    swing = np.where(gyro | ~answers(readings), 0.0, (readings / unit).std(axis=0))
    if swing.max() < LEAST_TURN:
        raise ScheduleError(
            [
                problem_at(
                    "table",
                    "all {r} rows have the same orientation: with nominal_scale the readings vary by {swing} g; "
                    "{advice}",
                    r=R,
                    swing=f"{swing.max():.1g}",
                    advice=advice(0),
                )
            ]
        )
    live = swing > LEAST_ANSWER * swing.max()
    spread = np.linalg.svd([s.nominal_axis for s, is_live in zip(session.sensors, live, strict=True) if is_live])[1]
    if live.sum() < 3 or spread[2] < FLATTEST * spread[0]:
        raise ScheduleError([Problem("sensors", too_few_axes(session, live, gyro))])
    return live, ~live & ~gyro, gyro


def too_few_axes(session: CalibrationSession, live: Mask, gyro: Mask) -> str:
    """The reason why the accelerometers cannot measure a vector, as a message."""
    silent = [s.name for s, dead in zip(session.sensors, ~live & ~gyro, strict=True) if dead]
    reason = say(" ({silent} did not respond to the rotation)", silent=joined(", ", silent)) if silent else ""
    return say(
        "the nominal axes of {live} accelerometers do not span space{reason}; arbitrary orientations need three or "
        "more axes that are not in one plane",
        live=int(live.sum()),
        reason=reason,
    )


def advice(rows: int) -> str:
    """The orientations to add to ``rows``, as a message."""
    return say(
        "add at least {number} so that there are {total} or more still orientations spread "
        "over the whole sphere, tilted about all three axes, or label six positions with their "
        "directions",
        number=GENERIC - rows,
        total=GENERIC,
    )
