"""A raw log → the stretches in which its block was at rest, in SI.

Labelled positions are rests; without labels they are found as `estimator.static` finds them, at one threshold. What is
quiet need not be at rest: on a stand or a bench it is, in service only where the specific force, by the unit's
calibration, has gravity's size and does not shake.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from estimator.applied_vector import STANDARD_GRAVITY
from estimator.errors import ScheduleError
from estimator.results import Calibration
from estimator.session import ACCELEROMETER, CALIBRATIONS, IN_SERVICE, Array, CalibrationSession, Sensor
from estimator.static import Intervals, labelled, moving, quietness, still, watched_for_rest

QUIET = 10.0
"""Variance of a window, in noise floors averaged over the channels, below which it may be at rest: no window of ten
samples or more reaches it by chance, and a touch by hand passes it a hundredfold."""
LEVEL = 0.01
"""Relative difference of the specific force from gravity, anywhere on Earth, up to which a block may be at rest."""
CALM = 0.1
"""m/s²; shaking up to which it may be: quieter than vehicles under way."""
GAP = 1.5
"""Sample intervals from which on a step of the time is a gap, which no rest goes across."""


@dataclass(frozen=True, eq=False)
class Rests:
    """The readings of a block at rest."""

    sensors: tuple[Sensor, ...]
    readings: tuple[Array, ...]
    """Readings of every rest, (n, m) m/s² or rad/s."""
    interval: float
    """s from sample to sample."""

    @property
    def longest(self) -> float:
        """s."""
        return max(map(len, self.readings)) * self.interval

    @property
    def lasted(self) -> float:
        """s, all together."""
        return sum(map(len, self.readings)) * self.interval


def rests_of(session: CalibrationSession, reference: Calibration | None = None) -> Rests | None:
    """The rests of a raw log; None where it holds none.

    Parameters
    ----------
    session : of any programme; averaged rows hold no rests.
    reference : the unit's calibration, without which nothing measured in service is known to be at rest.
    """
    if session.sample_rate is None or session.programme not in (*CALIBRATIONS, IN_SERVICE):
        return None
    intervals = _unbroken(session, _intervals(session))
    intervals = intervals.at(~moving(session, intervals))
    if session.programme == IN_SERVICE:
        intervals = intervals.at(_at_rest(session, intervals, reference))
    if not len(intervals):
        return None
    values = (session.readings - _offsets(session)) / _scales(session)
    stretches = tuple(values[a:b] for a, b in zip(intervals.start, intervals.stop, strict=True))
    return Rests(session.sensors, stretches, 1.0 / session.sample_rate)


def _intervals(session: CalibrationSession) -> Intervals:
    assert session.sample_rate is not None
    try:
        if session.position is not None:
            return labelled(session.position)
        if session.beta is not None and session.flipped is not None:
            setting = np.column_stack([session.beta, session.flipped])
            changed = np.any(np.diff(setting, axis=0) != 0, axis=1)
            return labelled(np.concatenate([[0], np.cumsum(changed)]))
    except ScheduleError:  # nothing is labelled
        return Intervals(np.empty(0, np.intp), np.empty(0, np.intp))
    quiet = quietness(session.readings[:, watched_for_rest(session)], session.sample_rate)
    return still(quiet, QUIET, session.sample_rate)


def _unbroken(session: CalibrationSession, intervals: Intervals) -> Intervals:
    """The stretches, cut where the time jumps."""
    if session.time is None or session.sample_rate is None:
        return intervals
    jumps = np.flatnonzero(np.diff(session.time) > GAP / session.sample_rate) + 1
    pieces = np.array(list(_cut(intervals, jumps)), dtype=np.intp).reshape(-1, 2)
    return Intervals(pieces[:, 0], pieces[:, 1])


def _cut(intervals: Intervals, jumps: Array) -> Iterator[tuple[int, int]]:
    for start, stop in zip(intervals.start, intervals.stop, strict=True):
        inside = jumps[(jumps > start) & (jumps < stop)]
        edges = [int(start), *inside.tolist(), int(stop)]
        yield from pairwise(edges)


def _at_rest(session: CalibrationSession, intervals: Intervals, reference: Calibration | None) -> NDArray[np.bool_]:
    """(n,) whether the specific force of a stretch has gravity's size and does not shake."""
    accelerometers = [i for i, sensor in enumerate(session.sensors) if sensor.kind == ACCELEROMETER]
    known = None if reference is None else _calibrated(session, accelerometers, reference)
    if known is None:
        return np.zeros(len(intervals), dtype=bool)
    scale, bias, axes = known
    inverse = np.linalg.pinv(axes)
    calm = np.zeros(len(intervals), dtype=bool)
    for i, (start, stop) in enumerate(zip(intervals.start, intervals.stop, strict=True)):
        force = (session.readings[start:stop, accelerometers] / scale - bias) @ inverse.T
        noise = np.sum(np.diff(force, axis=0).var(axis=0)) / 2
        level = abs(np.linalg.norm(force.mean(axis=0)) / STANDARD_GRAVITY - 1) < LEVEL
        calm[i] = level and np.sum(force.var(axis=0)) < CALM**2 + noise
    return calm


def _calibrated(
    session: CalibrationSession, accelerometers: list[int], reference: Calibration
) -> tuple[Array, Array, Array] | None:
    """Scale factors (a,), biases (a,) and axes (a, 3) of the ``accelerometers``, SI; None where one is missing."""
    calibrated = {sensor.name: sensor for sensor in reference.sensors}
    known = [calibrated.get(session.sensors[i].name) for i in accelerometers]
    rows = [
        (estimate.scale.value, estimate.bias.value, *estimate.axis)
        for estimate in known
        if estimate is not None
        and estimate.axis is not None
        and estimate.scale.value
        and estimate.bias.value is not None
    ]
    if len(rows) < max(len(accelerometers), 3):
        return None
    table = np.array(rows)
    offsets = _offsets(session)[accelerometers]
    return table[:, 0], table[:, 1] + offsets / table[:, 0], table[:, 2:]


def _offsets(session: CalibrationSession) -> Array:
    """(m,) reading units."""
    return np.array([sensor.nominal_offset or 0.0 for sensor in session.sensors])


def _scales(session: CalibrationSession) -> Array:
    """(m,) reading units per m/s² or rad/s."""
    pulses = 1.0 if session.count_time is None else session.count_time
    return np.array([s.nominal_scale * (1.0 if s.kind == ACCELEROMETER else pulses) for s in session.sensors])
