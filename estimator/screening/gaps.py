"""Raw logs with samples left out: without the stray ones of each rest, with gaps filled, and over windows."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from estimator.screening.findings import Sighting, seen, together
from estimator.screening.wild import without_wild
from estimator.session import Array, CalibrationSession, Sensor

FLOOR = 0.05
"""Part of all windows that is taken to be still; its upper end is the noise floor of a channel. A choice: small enough
for logs that hardly rest, large enough that the floor is not the luckiest window's."""


def without_stray(session: CalibrationSession, start: NDArray[np.intp], stop: NDArray[np.intp]) -> CalibrationSession:
    """The raw log without the samples that lie far from all others of their rest."""
    if "wild" in session.unscreened:
        return session
    readings, found = session.readings, list[Sighting]()
    for a, b in zip(start.tolist(), stop.tolist(), strict=True):
        wild = without_wild(readings[a:b])
        if wild is not None:
            readings = readings.copy() if readings is session.readings else readings
            readings[a:b][wild] = np.nan
            found += stray(session.sensors, wild, a)
    return replace(session, readings=readings, screening=(*session.screening, *together(found))) if found else session


def stray(sensors: tuple[Sensor, ...], wild: NDArray[np.bool_], at: int) -> list[Sighting]:
    """The sightings of ``wild`` samples (r, m) in the rows from ``at`` on."""
    channels = np.flatnonzero(wild.any(axis=0))
    return [item for i in channels for item in seen("wild", (sensors[i].name,), np.flatnonzero(wild[:, i]), at)]


def filled(readings: Array) -> Array:
    """Readings (R, m) with the last known one in every gap, the first before all; any unit."""
    known = np.isfinite(readings)
    if known.all():
        return readings
    last = np.maximum.accumulate(np.where(known, np.arange(len(readings))[:, None], -1), axis=0)
    first = np.where(known.any(axis=0), known.argmax(axis=0), 0)
    whole = np.take_along_axis(readings, np.where(last < 0, first, last), axis=0)
    return np.nan_to_num(whole)


def moments(readings: Array, block: int) -> tuple[Array, Array]:
    """(blocks, m) mean and variance of every whole block of readings (R, m), their unit (squared), NaN where hardly any
    is known."""
    count = len(readings) // block
    mean, within = np.empty((count, readings.shape[1])), np.empty((count, readings.shape[1]))
    for i, channel in enumerate(readings[: count * block].T):
        blocks = channel.reshape(count, block)
        mean[:, i], within[:, i] = blocks.mean(axis=1), blocks.var(axis=1)
        for k in np.flatnonzero(np.isnan(mean[:, i])).tolist():
            known = blocks[k][np.isfinite(blocks[k])]
            if len(known) > 1:
                mean[k, i], within[k, i] = known.mean(), known.var()
    return mean, within


def smallest_steps(readings: Array) -> Array:
    """(m,) least change, above zero, from sample to sample of readings (R, m), their unit; infinite where none is."""
    steps = [np.abs(np.diff(channel)) for channel in filled(readings).T]
    return np.array([changes.min(where=changes > 0, initial=np.inf) for changes in steps])


def noise_floor(variance: Array, step: float) -> float:
    """Variance of a channel at rest, its unit squared: that of its stillest windows, and not below its quantisation.

    variance : (W,) of its windows; step : its smallest, reading units; infinite where it never changes.
    """
    return max(float(np.quantile(variance, FLOOR)), step**2 / 12) if np.isfinite(step) else 1.0


def ends(readings: Array) -> Array:
    """(R, m, 2) 1 where a sample of readings (R, m) is its channel's largest, its smallest, else 0; no unit."""
    most, least = np.fmax.reduce(readings, axis=0), np.fmin.reduce(readings, axis=0)
    return np.stack([readings == most, readings == least], axis=-1).astype(float)
