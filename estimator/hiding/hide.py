"""A cause of the catalogue hidden in a session whose truth is known, for the diagnosis to find.

An effect is as strong as the diagnosis would see it: the norm of its whitened trace, what the baseline cannot absorb,
in standard errors (`estimator.diagnosis.residuals.whitened`). Where several amplitudes or places could be meant they
are drawn, each amplitude by what one unit of it leaves. A cause that shows against earlier sessions is as strong as it
stands out from them; every other one as it stands out within its session.

Two causes have no trace that grows with their amplitude. Clipping: `clipping` beside this file. Noise has no mean;
where A are the traces of one in each reading of a sensor, noise of standard deviation k gains on average
tr(k²AᵀA) − ln det(1 + k²AᵀA) of twice the log-likelihood. Of a mean effect that is the square of its strength, and so
it is taken as that of the noise.

Pulses are counted after an effect is added. Added to counts, what is less than half a pulse would be lost, and what is
more would become whole pulses, the same for sensors that turn through the same angles: another effect.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from estimator.causes.catalogue import CATALOGUE
from estimator.causes.contract import Cause, RecordCorrection, Setting, Shape, Signature
from estimator.causes.sensor import ExcessNoise
from estimator.diagnosis.diagnose import initial_state
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.residuals.whitened import INVISIBLE, WhitenedResiduals
from estimator.hiding.clipping import clipped
from estimator.hiding.hidden import HiddenCause, UnhideableError, amplitude_reaching
from estimator.session import Array, CalibrationSession
from estimator.simulate import counts_pulses, whole_pulses

LARGEST = 0.02
"""Change of a reading, in parts of the applied vector, that is still a flaw and no other device: 1° of an axis. Beyond
it the linear signature is no longer what the effect would do."""
RAREST = 1e6
"""Standard errors of one reading that noise may have at most."""


def hide(
    sessions: Sequence[CalibrationSession],
    cause: Cause,
    rng: np.random.Generator,
    *,
    strength: float,
    sensor: int | None = None,
    exact: bool = True,
) -> tuple[CalibrationSession, HiddenCause]:
    """The last of a unit's sessions with a cause in its readings or its record.

    Parameters
    ----------
    sessions : of one unit, oldest first; the earlier ones are what a cause that shows between sessions stands against.
        The last of pulse gyros is given before its pulses are counted (`estimator.simulate.uncounted`).
    cause : of the catalogue.
    rng : draws the sensor where none is named, and whatever else is open.
    strength : standard errors, of an effect; what is wrong in a record is there or not.
    sensor : the one to have it, counted from 0.
    exact : refuse where the cause can be hidden only more strongly; else it is hidden as weakly as it can be.

    Returns
    -------
    The session, and what is hidden in it.

    Raises
    ------
    UnhideableError : the sessions cannot hold the cause there, or not as strongly, or not as weakly.
    ValueError : pulses are counted already.
    ScheduleError : a session cannot be calibrated.
    """
    *earlier, session = sessions
    whole = whole_pulses(session)
    if isinstance(cause, RecordCorrection):
        return in_record(whole, cause, rng, sensor)
    if isinstance(cause, ExcessNoise):
        return with_noise(session, cause, rng, strength, sensor)
    assert isinstance(cause, Signature)
    if cause.clips:
        return clipped(whole, cause, rng, strength=strength, sensor=sensor, exact=exact)
    setting = baseline_of(whole).setting
    refuse_lacking(cause, setting, alone=not earlier)
    shape, amplitude = drawn_effect([*earlier, whole] if cause.between else [whole], cause, rng, strength, sensor)
    reported, _ = cause.reported(setting, shape, amplitude, np.zeros_like(amplitude))
    hidden = HiddenCause(cause.identifier, shape.sensors, (), tuple(reported.tolist()), shape.nonlinear, strength)
    return with_input(session, setting, shape.columns @ amplitude), hidden


def hide_any(
    sessions: Sequence[CalibrationSession],
    rng: np.random.Generator,
    *,
    strength: float,
    sensor: int | None = None,
    exact: bool = True,
) -> tuple[CalibrationSession, HiddenCause]:
    """The last of a unit's sessions with an effect of the catalogue that ``rng`` draws from those that it can hold.

    Errors of the record are not drawn: they have no strength. Otherwise as `hide`.
    """
    effects = [c for c in CATALOGUE if isinstance(c, Signature | ExcessNoise)]
    for k in rng.permutation(len(effects)).tolist():
        try:
            return hide(sessions, effects[k], rng, strength=strength, sensor=sensor, exact=exact)
        except UnhideableError:
            continue
    raise UnhideableError(f"no effect of the catalogue can be hidden here at {strength:g} standard errors")


def largest_of(setting: Setting) -> Array:
    """(m,) the largest change of each sensor's input, m/s² (rad/s); a gyro at rest has no input to compare it with."""
    turns = np.any(setting.n != 0.0, axis=(0, 2))
    return np.where(turns, LARGEST * setting.norm, np.inf)


def with_noise(
    session: CalibrationSession, cause: Cause, rng: np.random.Generator, strength: float, sensor: int | None
) -> tuple[CalibrationSession, HiddenCause]:
    """The session, its pulses not counted yet, with more noise in every reading of a sensor than is stated."""
    seen = WhitenedResiduals.of(baseline_of(whole_pulses(session)))
    R, m = session.readings.shape
    i = int(rng.integers(m)) if sensor is None else sensor
    columns = np.zeros((R, m, R))
    columns[np.arange(R), i, np.arange(R)] = 1.0
    trace = seen.trace(columns)
    grown = np.linalg.eigvalsh(trace.T @ trace).clip(min=0.0)

    def reached(k: float) -> float:
        return float(np.sqrt(np.sum(k**2 * grown - np.log1p(k**2 * grown))))

    most = largest_of(seen.baseline.setting)[i]
    k = amplitude_reaching(reached, strength, float(min(most, RAREST / np.sqrt(grown.max()))), cause)
    added = np.zeros((R, m))
    added[:, i] = k * rng.standard_normal(R)
    return with_input(session, seen.baseline.setting, added), HiddenCause(
        cause.identifier, (i,), (), (k,), (), strength
    )


def with_input(session: CalibrationSession, setting: Setting, added: Array) -> CalibrationSession:
    """The session with (R, m) more at its sensors' input, m/s² (rad/s), its pulses counted then.

    ValueError where they are counted already.
    """
    pulses = counts_pulses(session)
    pulse_counts = session.readings[:, pulses]
    if pulse_counts.size and np.array_equal(pulse_counts, np.round(pulse_counts)):
        raise ValueError("pulses are counted already: an effect of part of one would be lost or made whole")
    period = np.where(pulses, session.count_time or 1.0, 1.0)
    return whole_pulses(replace(session, readings=session.readings + setting.parameters.scale * added * period))


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
    residuals = initial_state(now, earlier, [cause]).residuals
    setting, unseen = residuals.baseline.setting, cause.between and residuals.change is None
    shapes = [] if unseen or not cause.available(setting) else list(cause.shapes(setting))
    if not shapes:
        raise UnhideableError(f"{cause.identifier} has nothing here to act on")
    if sensor is not None and not shapes[0].sensors:
        raise UnhideableError(f"{cause.identifier} is common to all sensors; name none")
    most = largest_of(now.setting)
    open_to = [k for k, shape in enumerate(shapes) if sensor is None or shape.sensors == (sensor,)]
    for k in rng.permutation(open_to).tolist():
        shape = shapes[k]
        columns, raw = residuals.trace(shape.columns, 0.0), np.linalg.norm(residuals.whitened(shape.columns), axis=0)
        size = np.linalg.norm(columns, axis=0)
        seen = size > INVISIBLE * raw
        if not seen.any():
            continue
        direction = np.where(seen, rng.standard_normal(len(size)) / np.where(seen, size, 1.0), 0.0)
        amplitude = strength * direction / np.linalg.norm(columns @ direction)
        if np.all(np.abs(shape.columns @ amplitude) < most):
            return shape, amplitude
    raise UnhideableError(
        f"{cause.identifier} would not reach {strength:g} standard errors with less than {LARGEST:.0%} of the input"
    )


def in_record(
    session: CalibrationSession, cause: RecordCorrection, rng: np.random.Generator, sensor: int | None
) -> tuple[CalibrationSession, HiddenCause]:
    """The session with an error of the record: what undoes one makes it, since done twice it is as before."""
    refuse_lacking(cause, baseline_of(session).setting, alone=False)
    chosen, count = None, 0
    for places, wrong in cause.corrected(session):
        if sensor is not None and (cause.of_rows or sensor not in places):
            continue
        count += 1
        if rng.integers(count) == 0:
            chosen = places, wrong
    if chosen is None:
        raise UnhideableError(f"{cause.identifier} is of no such sensor; name none")
    places, wrong = chosen
    rows, sensors = (places, ()) if cause.of_rows else ((), places)
    return wrong, HiddenCause(cause.identifier, sensors, rows)
