"""Many sessions at once: two-axis-stand sessions of one schedule are calibrated in one vectorised call.

All are solved when the call returns. A result is built when it is read: of ten thousand, few may be looked at.
"""

from collections import defaultdict
from collections.abc import Hashable, Sequence
from typing import overload

import numpy as np

from estimator.calibration.calibrate import calibrate
from estimator.calibration.gross import without_gross
from estimator.calibration.stand import calibrate_stand
from estimator.calibration.stand_report import Reports
from estimator.results import Calibration
from estimator.session import TWO_AXIS_STAND, CalibrationSession

CHUNK_READINGS = 10_000
"""Readings solved together: few enough for the arrays to stay in the processor's cache."""


class CalibrationBatch(Sequence[Calibration]):
    """Results in the order of the sessions; each is built when it is first read, and kept."""

    def __init__(self, places: Sequence[tuple[Reports | list[Calibration], int]]) -> None:
        self._places = places
        self._built: dict[int, Calibration] = {}

    def __len__(self) -> int:
        return len(self._places)

    @overload
    def __getitem__(self, place: int) -> Calibration: ...
    @overload
    def __getitem__(self, place: slice) -> list[Calibration]: ...
    def __getitem__(self, place: int | slice) -> Calibration | list[Calibration]:
        if isinstance(place, slice):
            return [self[k] for k in range(*place.indices(len(self)))]
        k = range(len(self))[place]
        if k not in self._built:
            reports, at = self._places[k]
            self._built[k] = reports[at]
        return self._built[k]


def together(session: CalibrationSession) -> bool:
    """Whether a session can be solved with others of its schedule."""
    return session.programme == TWO_AXIS_STAND and not session.is_raw


def schedule(session: CalibrationSession) -> Hashable:
    """Key of the sessions that can be solved together: everything but the readings, their errors and names."""
    assert session.beta is not None
    assert session.flipped is not None
    sensors = tuple((s.kind, s.nominal_axis.tobytes(), s.nominal_scale, s.bias_repeatability) for s in session.sensors)
    arrays = (
        session.beta.tobytes(),
        session.flipped.tobytes(),
        session.mounting.tobytes(),
        session.flip_turn.tobytes(),
        None if session.tilt_error is None else session.tilt_error.tobytes(),
    )
    return session.site, session.stand, session.count_time, sensors, arrays


def calibrate_many(sessions: Sequence[CalibrationSession]) -> CalibrationBatch:
    """Calibrations of sessions, one a session, in order; the same as `calibrate` of each.

    Two-axis-stand sessions that share a schedule are solved together, `CHUNK_READINGS` at a time, and each result is
    built when it is first read. A session that does not calibrate raises as `calibrate` does.
    """
    results: dict[int, tuple[Reports | list[Calibration], int]] = {}
    groups: defaultdict[Hashable, list[int]] = defaultdict(list)
    for k, session in enumerate(sessions):
        if together(session):
            groups[schedule(session)].append(k)
        else:
            results[k] = [calibrate(session)], 0
    for members in groups.values():
        size = max(1, CHUNK_READINGS // sessions[members[0]].readings.size)
        for chunk in np.array_split(members, -(-len(members) // size)):
            reports = calibrate_stand(without_gross([sessions[k] for k in chunk]))
            results.update((int(k), (reports, at)) for at, k in enumerate(chunk))
    return CalibrationBatch([results[k] for k in range(len(sessions))])
