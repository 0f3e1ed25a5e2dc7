"""A cause of the catalogue hidden in a session whose truth is known, for the diagnosis to find.

An effect is as strong as the diagnosis would see it: the norm of its whitened trace, what the baseline cannot absorb,
in standard errors (`estimator.diagnosis.residuals.whitened`). Where several amplitudes or places could be meant they
are drawn, each amplitude by what one unit of it leaves. A cause that shows against earlier sessions is as strong as it
stands out from them; every other one as it stands out within its session.

Two causes have no trace that grows with their amplitude. Clipping: the limit is lowered until what it cuts off is as
strong. Noise has no mean; where A are the traces of one in each reading of a sensor, noise of standard deviation k
gains on average tr(k²AᵀA) − ln det(1 + k²AᵀA) of twice the log-likelihood. Of a mean effect that is the square of its
strength, and so it is taken as that of the noise.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq

from estimator.causes.catalogue import CATALOGUE
from estimator.causes.contract import Cause, Correction, Setting, Shape, Signature
from estimator.causes.noise import ExcessNoise
from estimator.diagnosis.diagnose import unsearched
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.diagnosis.signatures.traces import INVISIBLE
from estimator.session import ACCELEROMETER, Array, CalibrationSession

LARGEST = 0.02
"""Change of a reading, in parts of the applied vector, that is still a flaw and no other device: 1° of an axis. Beyond
it the linear signature is no longer what the effect would do."""
DEEPEST = 0.3
"""Share of the largest reading that clipping takes at most: a range so much too small is seen by eye."""
FEWEST_CUT = 2
"""Readings that are clipped at least, on one side: one alone is a reading that does not belong to the rest."""
RAREST = 1e6
"""Standard errors of one reading that noise may have at most."""
FINEST = 1e-9
"""Share of the input from which on an amplitude is sought: nothing is seen of less."""


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
    if isinstance(cause, ExcessNoise):
        return with_noise(session, cause, rng, strength, sensor)
    assert isinstance(cause, Signature)
    if cause.clips:
        return clipped(session, cause, rng, strength, sensor)
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
    effects = [c for c in CATALOGUE if isinstance(c, Signature | ExcessNoise)]
    for k in rng.permutation(len(effects)).tolist():
        try:
            return hide(sessions, effects[k], rng, strength=strength, sensor=sensor)
        except UnhideableError:
            continue
    raise UnhideableError(f"no effect of the catalogue can be hidden here at {strength:g} standard errors")


def largest_of(setting: Setting) -> Array:
    """(m,) the largest change of each sensor's input, m/s² (rad/s); a gyro at rest has no input to compare it with."""
    turns = np.any(setting.n != 0.0, axis=(0, 2))
    return np.where(turns, LARGEST * setting.norm, np.inf)


def with_noise(
    session: CalibrationSession, cause: Cause, rng: np.random.Generator, strength: float, sensor: int | None
) -> tuple[CalibrationSession, Hidden]:
    """The session with more noise in every reading of a sensor than is stated."""
    seen = WhitenedResiduals.of(baseline_of(session))
    R, m = session.readings.shape
    i = int(rng.integers(m)) if sensor is None else sensor
    columns = np.zeros((R, m, R))
    columns[np.arange(R), i, np.arange(R)] = 1.0
    trace = seen.trace(columns)
    grown = np.linalg.eigvalsh(trace.T @ trace).clip(min=0.0)

    def reached(k: float) -> float:
        return float(np.sqrt(np.sum(k**2 * grown - np.log1p(k**2 * grown))))

    most = largest_of(seen.baseline.setting)[i]
    k = _reaching(reached, strength, float(min(most, RAREST / np.sqrt(grown.max()))), cause)
    added = np.zeros((R, m))
    added[:, i] = k * rng.standard_normal(R)
    return with_input(session, seen.baseline.setting, added), Hidden(cause.identifier, (i,), (), (k,), (), strength)


def clipped(
    session: CalibrationSession, cause: Cause, rng: np.random.Generator, strength: float, sensor: int | None
) -> tuple[CalibrationSession, Hidden]:
    """The session with a sensor that reads no more than a limit, on both sides or on one; it is stronger than was
    wished where otherwise one reading alone would be clipped."""
    seen = WhitenedResiduals.of(baseline_of(session))
    sensors = rng.permutation(session.readings.shape[1]) if sensor is None else [sensor]
    for i in sensors:
        for side in rng.permutation((0.0, 1.0, -1.0)):
            try:
                return _clipped_on(session, seen, (int(i), float(side), cause), strength)
            except UnhideableError:
                continue
    raise UnhideableError(f"{cause.identifier} would not reach {strength:g} standard errors with {DEEPEST:.0%} cut off")


def _clipped_on(
    session: CalibrationSession, seen: WhitenedResiduals, where: tuple[int, float, Cause], strength: float
) -> tuple[CalibrationSession, Hidden]:
    """Readings beyond the limit are one and the same to the last digit, as a converter gives them."""
    i, side, cause = where
    to_reading, zero = _reading_of(session, seen, i)
    felt = session.readings[:, i] / to_reading - zero
    size, sign = (np.abs(felt), np.sign(felt)) if side == 0 else (side * felt, np.full_like(felt, side))
    largest = float(size.max())

    def reached(depth: float) -> float:
        off = np.zeros_like(session.readings)
        off[:, i] = -sign * np.maximum(size - (largest - depth), 0.0)
        return float(np.linalg.norm(seen.trace(off[..., None])))

    depth = _reaching(reached, strength, DEEPEST * largest, cause)
    depth = max(depth, largest - _level_of_few(felt, side) + depth)
    limit, readings = largest - depth, session.readings.copy()
    at_limit = to_reading * (sign * limit + zero)
    readings[:, i] = np.where(
        size > limit, at_limit if session.count_time is None else np.round(at_limit), session.readings[:, i]
    )
    return replace(session, readings=readings), Hidden(
        cause.identifier, (i,), (), (limit,), (limit, side), reached(depth)
    )


def _reading_of(session: CalibrationSession, seen: WhitenedResiduals, i: int) -> tuple[float, float]:
    """What a reading of sensor i is of its input with its bias, reading units per m/s² (rad/s); and that bias."""
    own = seen.baseline.setting.parameters
    counted = session.count_time is not None and session.sensors[i].kind != ACCELEROMETER
    return float(own.scale[i]) * (session.count_time or 1.0 if counted else 1.0), float(own.bias[i])


def _level_of_few(felt: Array, side: float) -> float:
    """The highest level that as many of (R,) readings reach on a side as are clipped at least, m/s² (rad/s)."""
    sides = (side,) if side else (1.0, -1.0)
    return max(float(np.sort(one * felt)[-FEWEST_CUT]) for one in sides)


def _reaching(reached: Callable[[float], float], strength: float, most: float, cause: Cause) -> float:
    """The amplitude up to ``most`` at which a growing function reaches a strength, sought on a logarithmic scale."""
    if most <= 0 or reached(most) < strength:
        raise UnhideableError(
            f"{cause.identifier} would not reach {strength:g} standard errors with {most:.3g} {cause.units[0]}"
        )
    least = np.log(FINEST * most)
    return float(np.exp(brentq(lambda x: reached(np.exp(x)) - strength, least, np.log(most), xtol=1e-6)))


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
    most = largest_of(now.setting)
    open_to = np.flatnonzero((traces.sensor == sensor) if sensor is not None else np.ones(len(traces.shapes), bool))
    for k in rng.permutation(open_to).tolist():
        shape, columns, raw = traces.shapes[k], traces.columns[k], traces.raw[k]
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
