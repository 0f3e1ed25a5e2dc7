"""Record → means over equal times, at the input, position by position."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimator.applied_vector import STANDARD_GRAVITY
from estimator.session import ACCELEROMETER, Array, CalibrationSession
from estimator.static import MOTION

BLOCKS = 100
"""Means that a record is cut into at most: the slow course has a few parameters, and a hundred means hold it."""
SHORTEST = 1.0
"""s of a mean of samples, where the record allows it: shorter ones are noise alone."""
FULL = 0.5
"""Least share of the usual number of samples for a mean to be used; fewer stand beside a gap."""


@dataclass(frozen=True, eq=False)
class Series:
    """n means of m sensors."""

    time: Array
    """(n,) s since the first row, middles."""
    edges: Array
    """(n, 2) s since the first row, first and last sample."""
    value: Array
    """(n, m) m/s² or rad/s."""
    place: NDArray[np.intp]
    """(n,) number of the position in which the block stood."""
    count: Array
    """(n,) samples a mean."""
    inner: Array
    """(n, m) variance of a sample within the mean, (m/s²)² or (rad/s)²; NaN where there is one sample."""
    temperature: Array | None
    """(n,) °C."""

    def since(self, first: int) -> "Series":
        """The series from a mean on."""
        return Series(
            time=self.time[first:],
            edges=self.edges[first:],
            value=self.value[first:],
            place=self.place[first:],
            count=self.count[first:],
            inner=self.inner[first:],
            temperature=None if self.temperature is None else self.temperature[first:],
        )

    @property
    def change(self) -> Array:
        """(n, m) since the first mean of each position, m/s² or rad/s."""
        first = np.unique(self.place, return_index=True)[1]
        return np.asarray(self.value - self.value[first[np.unique(self.place, return_inverse=True)[1]]])


def times_of(session: CalibrationSession) -> Array | None:
    """(R,) s since the first row; None where the record does not say."""
    if session.time is not None:
        return np.asarray(session.time - session.time[0])
    if session.sample_rate is None:
        return None
    return np.arange(len(session.readings)) / session.sample_rate


def at_input(session: CalibrationSession) -> Array:
    """(R, m) readings by nominal scale factors and offsets, m/s² or rad/s."""
    scale = np.array([sensor.nominal_scale for sensor in session.sensors])
    offset = np.array([sensor.nominal_offset or 0.0 for sensor in session.sensors])
    return np.asarray((session.readings - offset) / (scale * (session.count_time or 1.0)))


def series_of(session: CalibrationSession, time: Array) -> Series:
    """The means; ``time`` (R,) in s."""
    value, place = at_input(session), places(session)
    width = max(float(time[-1]) / BLOCKS, SHORTEST if session.is_raw else 0.0)
    alone = not session.is_raw and len(time) <= BLOCKS
    slot = (
        np.arange(len(time)) if alone else np.floor(time / width).astype(np.intp) if width > 0 else np.zeros(len(time))
    )
    begin = np.flatnonzero(np.r_[True, (np.diff(slot) != 0) | (np.diff(place) != 0)])
    count = np.diff(np.append(begin, len(time)))
    full = count >= FULL * np.median(count)
    end = begin + count - 1
    mean = np.add.reduceat(value, begin, axis=0) / count[:, None]
    return Series(
        time=_mean(time, begin, count)[full],
        edges=np.column_stack([time[begin], time[end]])[full],
        value=mean[full],
        place=place[begin][full],
        count=count[full].astype(float),
        inner=_inner(value, np.repeat(mean, count, axis=0), begin, count)[full],
        temperature=None if session.temperature is None else _mean(session.temperature, begin, count)[full],
    )


def _mean(values: Array, begin: NDArray[np.intp], count: NDArray[np.intp]) -> Array:
    return np.asarray(np.add.reduceat(values, begin) / count)


def _inner(value: Array, mean: Array, begin: NDArray[np.intp], count: NDArray[np.intp]) -> Array:
    squares = np.add.reduceat((value - mean) ** 2, begin, axis=0)
    return np.asarray(squares / np.where(count > 1, count - 1.0, np.nan)[:, None])


def places(session: CalibrationSession) -> NDArray[np.intp]:
    """(R,) numbers of the positions, by labels or settings; rows of neither are distinguished by what they read."""
    if session.position is not None:
        return np.asarray(session.position, dtype=np.intp)
    if session.beta is not None and session.flipped is not None:
        settings = np.column_stack([np.round(np.mod(session.beta, 2 * np.pi), 9), session.flipped])
        return np.unique(settings, axis=0, return_inverse=True)[1].ravel()
    if session.is_raw:
        return np.zeros(len(session.readings), dtype=np.intp)
    felt = [i for i, sensor in enumerate(session.sensors) if sensor.kind == ACCELEROMETER]
    moved = (np.abs(np.diff(at_input(session)[:, felt], axis=0)) > MOTION * STANDARD_GRAVITY).any(axis=1)
    return np.concatenate([[0], np.cumsum(moved)]).astype(np.intp)
