"""A cause of the catalogue hidden in a session whose truth is known, for the diagnosis to find.

An effect is as strong as the diagnosis would see it: the norm of its whitened trace, what the baseline cannot absorb,
in standard errors (`estimator.diagnosis.residuals.whitened`). Where several amplitudes or places could be meant they
are drawn, each amplitude by what one unit of it leaves. A cause that shows against earlier sessions is as strong as it
stands out from them; every other one as it stands out within its session.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from estimator.causes.catalogue import CATALOGUE
from estimator.causes.contract import Cause, Correction, Setting, Shape, Signature
from estimator.diagnosis.diagnose import unsearched
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.signatures.traces import INVISIBLE
from estimator.session import ACCELEROMETER, Array, CalibrationSession

LARGEST = 0.02
"""Change of a reading, in parts of the applied vector, that is still a flaw and no other device: 1° of an axis. Beyond
it the linear signature is no longer what the effect would do."""


class UnhideableError(ValueError):
    """This session cannot hold the cause, or not as strongly; the text says why."""


@dataclass(frozen=True)
class Hidden:
    """What was hidden."""

    cause: str
    sensors: tuple[int, ...] = ()
    """Counted from 0; empty for what is common to all."""
    rows: tuple[int, ...] = ()
    """Counted from 0; empty but for rows exchanged."""
    amplitude: tuple[float, ...] = ()
    """SI, as `units` of the cause; empty for an error of the record."""
    nonlinear: tuple[float, ...] = ()
    """As `nonlinear_units` of the cause."""
    strength: float | None = None
    """Standard errors; None for an error of the record, which is there or not."""


def hide(
    sessions: Sequence[CalibrationSession],
    cause: Cause,
    rng: np.random.Generator,
    *,
    strength: float,
    sensor: int | None = None,
) -> tuple[CalibrationSession, Hidden]:
    """The last of a unit's sessions with a cause in its readings or its record.

    Parameters
    ----------
    sessions : of one unit, oldest first; the earlier ones are what a cause that shows between sessions stands against.
    cause : of the catalogue.
    rng : draws the sensor where none is named, and whatever else is open.
    strength : standard errors, of an effect; what is wrong in a record is there or not.
    sensor : the one to have it, counted from 0.

    Returns
    -------
    The session, and what is hidden in it.

    Raises
    ------
    UnhideableError : the sessions cannot hold the cause there, or not as strongly.
    ScheduleError : a session cannot be calibrated.
    """
    session = sessions[-1]
    if isinstance(cause, Correction):
        return in_record(session, cause, rng, sensor)
    if not isinstance(cause, Signature) or cause.clips:
        raise UnhideableError(f"{cause.identifier} has no amplitude that a strength could set")
    setting = baseline_of(session).setting
    refuse_lacking(cause, setting, alone=len(sessions) == 1)
    shape, amplitude = drawn_effect(sessions if cause.between else [session], cause, rng, strength, sensor)
    told, _ = cause.reported(setting, shape, amplitude, np.zeros_like(amplitude))
    hidden = Hidden(cause.identifier, shape.sensors, (), tuple(told.tolist()), shape.nonlinear, strength)
    return with_input(session, setting, shape.columns @ amplitude), hidden


def hide_any(
    sessions: Sequence[CalibrationSession], rng: np.random.Generator, *, strength: float, sensor: int | None = None
) -> tuple[CalibrationSession, Hidden]:
    """The last of a unit's sessions with an effect of the catalogue that ``rng`` draws from those that it can hold.

    Errors of the record are not drawn: they have no strength. Otherwise as `hide`.
    """
    effects = [c for c in CATALOGUE if isinstance(c, Signature)]
    for k in rng.permutation(len(effects)).tolist():
        try:
            return hide(sessions, effects[k], rng, strength=strength, sensor=sensor)
        except UnhideableError:
            continue
    raise UnhideableError(f"no effect of the catalogue can be hidden here at {strength:g} standard errors")


def with_input(session: CalibrationSession, setting: Setting, added: Array) -> CalibrationSession:
    """The session with (R, m) more at its sensors' input, m/s² (rad/s); pulse gyros still count whole pulses."""
    change = setting.parameters.scale * added
    if session.count_time is None:
        return replace(session, readings=session.readings + change)
    gyro = np.array([s.kind != ACCELEROMETER for s in session.sensors])
    counts = np.round(session.readings + change * session.count_time)
    return replace(session, readings=np.where(gyro, counts, session.readings + change))


def refuse_lacking(cause: Cause, setting: Setting, *, alone: bool) -> None:
    """UnhideableError where the session, ``alone`` or after others, has not what a cause needs."""
    if cause.kind is not None and cause.kind not in setting.kinds:
        raise UnhideableError(f"{cause.identifier} is of a {cause.kind}, and the block has none")
    lacking = [need for need in sorted(cause.needs) if not setting.has(need)]
    if lacking or (cause.between and alone):
        needed = " and ".join(lacking or ["history"])
        raise UnhideableError(f"{cause.identifier} needs {needed}, which is not there")


def drawn_effect(
    sessions: Sequence[CalibrationSession],
    cause: Signature,
    rng: np.random.Generator,
    strength: float,
    sensor: int | None,
) -> tuple[Shape, Array]:
    """A shape of the cause and its amplitudes (q,), per column of the shape, of a strength in standard errors."""
    *earlier, now = (baseline_of(session) for session in sessions)
    traces = next(iter(unsearched(now, earlier, [cause]).traces), None)
    if traces is None:
        raise UnhideableError(f"{cause.identifier} has nothing here to act on")
    if sensor is not None and traces.common:
        raise UnhideableError(f"{cause.identifier} is common to all sensors; name none")
    open_to = np.flatnonzero((traces.sensor == sensor) if sensor is not None else np.ones(len(traces.shapes), bool))
    for k in rng.permutation(open_to).tolist():
        shape, columns, raw = traces.shapes[k], traces.columns[k], traces.raw[k]
        size = np.linalg.norm(columns, axis=0)
        seen = size > INVISIBLE * raw
        if not seen.any():
            continue
        direction = np.where(seen, rng.standard_normal(len(size)) / np.where(seen, size, 1.0), 0.0)
        amplitude = strength * direction / np.linalg.norm(columns @ direction)
        if np.all(np.abs(shape.columns @ amplitude) < LARGEST * now.setting.norm):
            return shape, amplitude
    raise UnhideableError(
        f"{cause.identifier} would not reach {strength:g} standard errors with less than {LARGEST:.0%} of the input"
    )


def in_record(
    session: CalibrationSession, cause: Correction, rng: np.random.Generator, sensor: int | None
) -> tuple[CalibrationSession, Hidden]:
    """The session with an error of the record: what undoes one makes it, since done twice it is as before."""
    refuse_lacking(cause, baseline_of(session).setting, alone=False)
    chosen, found = None, 0
    for places, wrong in cause.corrected(session):
        if sensor is not None and (cause.of_rows or sensor not in places):
            continue
        found += 1
        if rng.integers(found) == 0:
            chosen = places, wrong
    if chosen is None:
        raise UnhideableError(f"{cause.identifier} is of no such sensor; name none")
    places, wrong = chosen
    rows, sensors = (places, ()) if cause.of_rows else ((), places)
    return wrong, Hidden(cause.identifier, sensors, rows)
