"""A record of the first minutes → ready, wait, not still, or too early to say."""

from dataclasses import replace

import numpy as np

from estimator.readiness.course import WIDE, SettlingCourse, courses, first_scatter, needed, wander
from estimator.readiness.creep import turn
from estimator.readiness.faults import RecordFault, content_faults, force_of, is_spatial, readable
from estimator.readiness.forecast import LIKELY, DrawnDrift, departures, drawn, wait
from estimator.readiness.question import Question
from estimator.readiness.results import Disturbance, DisturbanceKind, DriftOutlook, Readiness, ReadinessState
from estimator.readiness.series import Series
from estimator.readiness.stillness import clipped, first_and_last, shaking
from estimator.session import ACCELEROMETER, Array, CalibrationSession

REACH = 20.0
"""Lengths of the record that it is carried ahead at most: what begins to move only later is no first-order settling,
and a record of a twentieth of the programme has seen the first of it."""
CALM = 20
"""Means after the last disturbance from which the rest of a record is judged without what came before."""
FELT = 0.5
"""Gravity along an axis, as a part of g, from which a drift could be the scale factor's: less of it would need a larger
change than the zero's own.
"""


def readiness(session: CalibrationSession, question: Question, rng: np.random.Generator) -> Readiness:
    """Decides whether the unit is warm and still enough for the planned programme.

    Parameters
    ----------
    session : the first rows, or the first minutes of a raw log, at rest; (R, m) readings in reading units, times in s.
    question : how long the programme takes, s, and the tolerances in SI.
    rng : draws the forecasts.

    Returns
    -------
    The answer; what is wrong with the record is part of it and raises nothing.
    """
    series, faults = readable(session)
    if series is None:
        return _unread(session, question, faults)
    allowed, limits = allowances(session, series, question)
    faults = content_faults(session, series, allowed)
    if any(fault.blocks for fault in faults):
        return _with_record(_unread(session, question, faults), series)
    return _judged(session, question, (series, allowed, limits), faults, rng)


def allowances(session: CalibrationSession, series: Series, question: Question) -> tuple[Array, list[str]]:
    """(m,) drift allowed, m/s² or rad/s, infinite where nothing is judged; and whose tolerance is the nearer one."""
    force = np.linalg.norm(force_of(session, series)) if is_spatial(session) else np.inf
    felt = np.abs(np.median(series.value[series.place == series.place[-1]], axis=0))
    most, limits = [], []
    for sensor, f in zip(session.sensors, felt, strict=True):
        tolerance = question.tolerances.get(sensor.kind)
        bias = np.inf if tolerance is None or tolerance.bias is None else tolerance.bias
        seen = sensor.kind == ACCELEROMETER and f >= FELT * force
        scale = np.inf if tolerance is None or tolerance.scale is None or not seen else tolerance.scale * f
        most.append(question.share * min(bias, scale))
        limits.append("scale" if scale < bias else "bias")
    return np.array(most), limits


def _judged(
    session: CalibrationSession,
    question: Question,
    limited: tuple[Series, Array, list[str]],
    faults: tuple[RecordFault, ...],
    rng: np.random.Generator,
) -> Readiness:
    series, allowed, limits = limited
    names = tuple(sensor.name for sensor in session.sensors)
    marks = first_and_last(series, names, allowed)
    first = max((mark for mark, _ in marks), default=0)
    calm = len(series.time) - first >= CALM
    rest = series.since(first) if calm else series
    persisting = _persisting(session, series, rest, question, allowed)
    disturbances = (*(replace(outlook, passed=calm) for _, outlook in marks), *persisting)
    held = courses(rest.time, rest.value, rest.place, rest.count, _wide(rest, allowed))
    drawings = [drawn(course, rng) for course in held]
    outlooks = tuple(
        _outlook(i, session, question, (held[i], drawings[i], len(rest.time), float(allowed[i]), limits[i]), rng)
        for i in range(len(names))
        if np.isfinite(allowed[i])
    )
    outlooks = tuple(_shares(outlook, session, rest, question) for outlook in outlooks)
    thermal = _thermal(session, rest, question, rng)
    base = Readiness(
        unit=session.unit,
        state=ReadinessState.TOO_EARLY,
        outlooks=outlooks,
        disturbances=disturbances,
        faults=faults,
        duration=question.duration,
        recorded=float(series.edges[-1, 1]),
        judged_from=float(rest.edges[0, 0]),
        time=rest.time,
        change=rest.change,
        names=names,
        temperature=thermal,
        warmed=None if rest.temperature is None else float(rest.temperature[-1] - rest.temperature[0]),
    )
    return _stated(base, _creep(session, rest, question, drawings))


def _persisting(
    session: CalibrationSession, series: Series, rest: Series, question: Question, allowed: Array
) -> list[Disturbance]:
    """Disturbances that do not pass by themselves."""
    names = tuple(sensor.name for sensor in session.sensors)
    tolerances = [question.tolerances.get(sensor.kind) for sensor in session.sensors]
    quadratic = np.array(
        [0.0 if tolerance is None or tolerance.quadratic is None else tolerance.quadratic for tolerance in tolerances]
    )
    disturbances = shaking(rest, names, quadratic, allowed)
    return disturbances + (clipped(session.readings, names, float(series.edges[-1, 1])) if session.is_raw else [])


def _wide(series: Series, allowed: Array) -> Array:
    most = np.where(np.isfinite(allowed), allowed, first_scatter(series.value, series.place))
    return np.asarray(WIDE * np.maximum(most, np.ptp(series.change, axis=0)))


def _outlook(
    i: int,
    session: CalibrationSession,
    question: Question,
    drift: tuple[SettlingCourse, DrawnDrift, int, float, str],
    rng: np.random.Generator,
) -> DriftOutlook:
    course, drawing, means, allowed, limit = drift
    far = departures(drawing, question.duration, rng)
    chance = float(np.mean(far > allowed))
    is_warm, short = chance <= 1 - LIKELY, question.duration / REACH - course.span
    length = None if is_warm else needed(course, means, question.duration, allowed)
    return DriftOutlook(
        name=session.sensors[i].name,
        kind=session.sensors[i].kind,
        expected=float(np.median(far)),
        bound=float(np.quantile(far, LIKELY)),
        chance=chance,
        allowed=allowed,
        limit=limit,
        wait=None if is_warm else wait(drawing, question.duration, allowed),
        needed=max(length or 0.0, short) if short > 0 else length,
        wander=wander(course, question.duration),
    )


def _shares(outlook: DriftOutlook, session: CalibrationSession, series: Series, question: Question) -> DriftOutlook:
    """The outlook with its bound as shares of the tolerances."""
    i = [sensor.name for sensor in session.sensors].index(outlook.name)
    tolerance = question.tolerances[outlook.kind]
    felt = float(np.abs(np.median(series.value[:, i])))
    return replace(
        outlook,
        bias_share=outlook.bound / tolerance.bias if tolerance.bias else None,
        scale_share=outlook.bound / (tolerance.scale * felt)
        if tolerance.scale and felt and outlook.kind == ACCELEROMETER
        else None,
    )


def _thermal(
    session: CalibrationSession, series: Series, question: Question, rng: np.random.Generator
) -> DriftOutlook | None:
    """Forecast of the zeros from the thermometer and the stated coefficient; None where either is missing."""
    kind = ACCELEROMETER if any(s.kind == ACCELEROMETER for s in session.sensors) else session.sensors[0].kind
    coefficient, tolerance = (question.coefficient or {}).get(kind), question.tolerances.get(kind)
    warmth = series.temperature
    if warmth is None or coefficient is None or tolerance is None or tolerance.bias is None or np.ptp(warmth) == 0:
        return None
    value, allowed = coefficient * warmth[:, None], question.share * tolerance.bias
    same = np.zeros_like(series.place)
    wide = np.array([WIDE * max(allowed, float(np.ptp(value)))])
    course = courses(series.time, value, same, series.count, wide)[0]
    drift = (course, drawn(course, rng), len(series.time), allowed, "bias")
    named = replace(session, sensors=(replace(session.sensors[0], name="temperature", kind=kind),))
    return replace(_outlook(0, named, question, drift, rng), needed=None)


def _creep(
    session: CalibrationSession, series: Series, question: Question, drawings: list[DrawnDrift]
) -> Disturbance | None:
    """A turn that explains what all accelerometers are going to do."""
    felt = [i for i, sensor in enumerate(session.sensors) if sensor.kind == ACCELEROMETER]
    if not felt or not is_spatial(session):
        return None
    ends = np.stack([drawings[i].to_come(0.0, question.duration)[:, -1] for i in felt], axis=1)
    axes = np.stack([session.sensors[i].nominal_axis for i in felt])
    size = turn(axes, force_of(session, series), np.median(ends, axis=0), ends.std(axis=0))
    if size is None:
        return None
    names = tuple(session.sensors[i].name for i in felt)
    return Disturbance(DisturbanceKind.CREEP, names, float(series.edges[0, 0]), float(series.edges[-1, 1]), size)


def _stated(base: Readiness, creep: Disturbance | None) -> Readiness:
    """The answer: what is to be done first comes first."""
    judged = base.outlooks if base.temperature is None else (*base.outlooks, base.temperature)
    late = 1 - (1 - LIKELY) / max(len(judged), 1)
    if any(not item.passed for item in base.disturbances):
        return replace(base, state=ReadinessState.NOT_STILL)
    if any(item.chance >= late for item in judged):
        if creep is None:
            return replace(base, state=ReadinessState.NOT_WARM)
        return replace(base, state=ReadinessState.NOT_STILL, disturbances=(*base.disturbances, creep))
    long_enough = base.recorded - base.judged_from >= base.duration / REACH
    is_warm = all(item.chance <= 1 - LIKELY for item in judged)
    return replace(base, state=ReadinessState.READY if is_warm and long_enough else ReadinessState.TOO_EARLY)


def _unread(session: CalibrationSession, question: Question, faults: tuple[RecordFault, ...]) -> Readiness:
    """The answer where no judgement is possible."""
    names = tuple(sensor.name for sensor in session.sensors)
    none = np.zeros((0, len(names)))
    fields = (
        session.unit,
        ReadinessState.CANNOT_TELL,
        (),
        (),
        faults,
        question.duration,
        0.0,
        0.0,
        np.zeros(0),
        none,
        names,
    )
    return Readiness(*fields)


def _with_record(base: Readiness, series: Series) -> Readiness:
    """The answer with the recorded means."""
    return replace(base, recorded=float(series.edges[-1, 1]), time=series.time, change=series.change)
