"""Many sessions at once: two-axis-stand sessions of one schedule are calibrated in one vectorised call."""

from collections import defaultdict
from collections.abc import Hashable, Sequence

import numpy as np

from estimator.calibration.calibrate import calibrate
from estimator.calibration.stand import calibrate_stand
from estimator.results import Calibration
from estimator.session import TWO_AXIS_STAND, CalibrationSession

CHUNK_READINGS = 10_000
"""Readings solved together: few enough for the arrays to stay in the processor's cache."""


def together(session: CalibrationSession) -> bool:
    """Whether a session can be solved with others of its schedule."""
    return session.programme == TWO_AXIS_STAND and not session.is_raw


def schedule(session: CalibrationSession) -> Hashable:
    """What two sessions must share to be solved together: everything but the readings, their errors and names."""
    assert session.beta is not None
    assert session.flipped is not None
    sensors = tuple((s.kind, s.nominal_axis.tobytes(), s.nominal_scale, s.bias_repeatability) for s in session.sensors)
    arrays = (
        session.beta.tobytes(),
        session.flipped.tobytes(),
        session.mounting.tobytes(),
        session.flip_turn.tobytes(),
    )
    return session.site, session.stand, session.count_time, sensors, arrays


def calibrate_many(sessions: Sequence[CalibrationSession]) -> list[Calibration]:
    """Calibrations of sessions, one a session, in order; the same as `calibrate` of each.

    Two-axis-stand sessions that share a schedule are solved together, `CHUNK_READINGS` at a time. A session that does
    not calibrate raises as `calibrate` does.
    """
    found: dict[int, Calibration] = {}
    groups: defaultdict[Hashable, list[int]] = defaultdict(list)
    for k, session in enumerate(sessions):
        if together(session):
            groups[schedule(session)].append(k)
        else:
            found[k] = calibrate(session)
    for members in groups.values():
        size = max(1, CHUNK_READINGS // sessions[members[0]].readings.size)
        for chunk in np.array_split(members, -(-len(members) // size)):
            results = calibrate_stand([sessions[k] for k in chunk])
            found.update(zip(map(int, chunk), results, strict=True))
    return [found[k] for k in range(len(sessions))]
