"""Residuals on positions that took no part in the calibration."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from benchmarks.recordings.triad import Triad
from estimator.session import Array, CalibrationSession

FOLDS = 5

Calibrate = Callable[[CalibrationSession], list[Triad]]
"""A session → its triads, each of three neighbouring accelerometers."""


def rows(session: CalibrationSession, chosen: Array) -> CalibrationSession:
    """Some rows of an averaged session."""

    def of(column: Array | None) -> Array | None:
        return None if column is None else column[chosen]

    return replace(
        session,
        readings=session.readings[chosen],
        standard_errors=session.standard_errors[chosen],
        time=of(session.time),
        temperature=of(session.temperature),
        directions=of(session.directions),
        tilt_error=of(session.tilt_error),
        at_ends=of(session.at_ends),
        position=None,
    )


def misses(triads: list[Triad], readings: Array, g: float) -> Array:
    """(R, T) |a| − g of T triads, m/s²."""
    return np.column_stack(
        [np.linalg.norm(t.force(readings[:, 3 * k : 3 * k + 3]), axis=1) - g for k, t in enumerate(triads)]
    )


def held_out(session: CalibrationSession, g: float, calibrate: Calibrate) -> Array:
    """(T,) root mean square of |a| − g over all positions, each judged by a calibration without it."""
    fold = np.arange(len(session.readings)) % FOLDS
    found = [misses(calibrate(rows(session, fold != k)), session.readings[fold == k], g) for k in range(FOLDS)]
    return np.asarray(np.sqrt(np.mean(np.vstack(found) ** 2, axis=0)))


def rms(triads: list[Triad], session: CalibrationSession, g: float) -> Array:
    """(T,) root mean square of |a| − g of fixed triads."""
    return np.asarray(np.sqrt(np.mean(misses(triads, session.readings, g) ** 2, axis=0)))
