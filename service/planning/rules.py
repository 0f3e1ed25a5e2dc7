"""Plans of sessions, readiness of units, and missing positions of a session; nothing is stored."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.linalg import LinAlgError

from estimator.errors import Problem, ScheduleError, SessionError
from estimator.message import say
from estimator.planning import Missing, Plan, missing
from estimator.planning import plan as plan_session
from estimator.readiness import Readiness, ReadinessState, readiness
from estimator.session import CALIBRATIONS, CalibrationSession
from service.errors import NotFoundError, RefusedError
from service.ingest import in_turn, read_first_rows, read_upload
from service.kit.arriving_files import where
from service.kit.measures import leading_kind
from service.planning.pattern import completed, earlier, sensors_of, why_not
from service.planning.question import PlanQuestion, ReadyQuestion
from service.planning.words import missing_in_words, readiness_headline, reasons
from service.sessions.records import PARAMETERS
from service.sessions.sent import SentFile
from service.sessions.words.conditions import Condition
from service.storage import Storage
from service.types.rules import DEFAULTS, tolerances_of
from service.types.store import UnitTypes
from service.units.store import Units

AMOUNTS = ("theta", "alpha_error", "beta_error", "noise", "variation")
TOO_FAR_APART = "This cannot be planned: errors of the stand and noise lie too many orders of magnitude apart."
APART = "bring it nearer to the others"
MOST_TYPES = 500
"""Types that are offered for a choice."""


def plan(storage: Storage, question: PlanQuestion) -> tuple[PlanQuestion, Plan]:
    """The question with what the type knows filled in, and its plan."""
    if not question.unit_type:
        return question, _of_cone(question)
    with storage.database.reading() as store:
        unit_type = UnitTypes(store).get(question.unit_type)
    problems = why_not(unit_type)
    if problems:
        raise RefusedError(say("Units of the type {name} cannot be planned for.", name=repr(unit_type.name)), problems)
    whole = completed(question, unit_type)
    return whole, _planned(whole, whole.block(sensors_of(unit_type)), whole.kind)


@lru_cache(maxsize=64)
def _of_cone(question: PlanQuestion) -> Plan:
    """The plan for sensors on a cone: the question alone decides it, and the empty one of the page is everybody's
    first.
    """
    return _planned(question, question.cone(), question.kind)


def _planned(question: PlanQuestion, like: CalibrationSession, kind: str) -> Plan:
    """The plan; RefusedError where the amounts are such that no computation of 16 digits holds them together."""
    try:
        return plan_session(like, question.request(kind), sigma=question.sigma(like))
    except LinAlgError as fault:
        raise RefusedError(TOO_FAR_APART, tuple(Problem(name, APART) for name in AMOUNTS)) from fault


def plannable_types(storage: Storage) -> tuple[str, ...]:
    """Names of the stored types that can be planned for."""
    with storage.database.reading() as store:
        listed = UnitTypes(store).page(0, MOST_TYPES)
    return tuple(known.name for known in listed if not why_not(known))


READY = Condition("pass", "Ready", "circle", "The measurement may begin.")
COMPLETE = Condition("pass", "Complete", "circle", "No position is missing.")
INCOMPLETE = Condition("conditional-pass", "Incomplete", "triangle-up", "Positions are missing.")
WAIT = Condition("conditional-pass", "Not yet", "triangle-up", "Wait, or record for longer.")
NOT_STILL = Condition("fail", "Not still", "square", "It moves or vibrates.")
NOTHING = Condition("none", "No usable data", "stroke", "The record contains no information.")
CONDITIONS = {
    ReadinessState.READY: READY,
    ReadinessState.NOT_STILL: NOT_STILL,
    ReadinessState.NOT_WARM: WAIT,
    ReadinessState.TOO_EARLY: WAIT,
    ReadinessState.CANNOT_TELL: NOTHING,
}


@dataclass(frozen=True)
class SoFar:
    """A session that is being measured."""

    condition: Condition
    said: tuple[str, ...]
    """The positions and parameters that are missing; of one position alone, whether the unit is warm and still."""


def so_far(storage: Storage, session: CalibrationSession) -> SoFar | None:
    """The session as far as it is measured; None of a programme without a calibration."""
    if session.programme not in CALIBRATIONS:
        return None
    try:
        found = missing(session)
    except ScheduleError as fault:
        answer = _answered(storage, session, ReadyQuestion.model_validate({}))
        said = (readiness_headline(answer.found), *reasons(answer.found, answer.kind))
        if session.sample_rate is None and is_of_one_position(session):
            return SoFar(CONDITIONS[answer.found.state], said)
        is_still = answer.found.state not in (ReadinessState.NOT_STILL, ReadinessState.CANNOT_TELL)
        return SoFar(INCOMPLETE, (*(problem.message for problem in fault.problems), *(said if is_still else ())))
    return SoFar(COMPLETE if found.is_complete else INCOMPLETE, missing_in_words(found))


def is_of_one_position(session: CalibrationSession) -> bool:
    """Whether all rows of a stand have one setting."""
    settings = [labels for labels in (session.beta, session.flipped) if labels is not None]
    return bool(settings) and all(len(np.unique(labels)) == 1 for labels in settings)


def read_so_far(file: SentFile) -> CalibrationSession:
    """The session in a file, however little of it is measured; RefusedError with every problem."""
    content = where(file.content)
    try:
        with in_turn(content):
            try:
                return read_upload(content, file.filename, file.mapping)
            except SessionError:
                return read_first_rows(content, file.filename, file.mapping)
    except SessionError as fault:
        raise RefusedError(say("{filename} cannot be read so far.", filename=file.filename), fault.problems) from fault


def missing_of(file: SentFile, positions: int | None, *, both_runs: bool) -> Missing:
    """The positions and uncertainties still to come; RefusedError with every problem where the file cannot be read so
    far.
    """
    session = read_so_far(file)
    try:
        return missing(session, positions, both_runs=both_runs)
    except SessionError as fault:
        raise RefusedError(say("{filename} cannot be read so far.", filename=file.filename), fault.problems) from fault


SEED = 1
"""Seed of the draws: the same file has the same answer."""


@dataclass(frozen=True)
class Asked:
    """The answer, and the basis of its judgement."""

    found: Readiness
    kind: str
    """Kind of the leading sensors."""
    unit_type: str | None
    """Unit type whose tolerances were taken; None: the defaults."""
    is_usual: bool
    """Whether the duration was nobody's, but the usual one."""


def readiness_of(storage: Storage, file: SentFile, asked: ReadyQuestion) -> Asked:
    """Ready or not; RefusedError with every problem where the file cannot be read."""
    content = where(file.content)
    try:
        with in_turn(content):
            return _answered(storage, read_first_rows(content, file.filename, file.mapping), asked)
    except SessionError as fault:
        raise RefusedError(say("{filename} cannot be read so far.", filename=file.filename), fault.problems) from fault


def judged_by_defaults(session: CalibrationSession, asked: ReadyQuestion) -> Asked:
    """The answer without a store, by the default tolerances, as for an unknown unit."""
    return _asked(session, asked, None, defaults(), None)


def defaults() -> dict[tuple[str, str], float]:
    """The tolerances that hold until an engineer sets others."""
    stated = {(kind, name): getattr(default, name) for kind, default in DEFAULTS.items() for name in PARAMETERS}
    return {key: tolerance for key, tolerance in stated.items() if tolerance is not None}


def _answered(storage: Storage, session: CalibrationSession, asked: ReadyQuestion) -> Asked:
    known = None
    with storage.database.reading() as store:
        if asked.unit_type:
            known = UnitTypes(store).get(asked.unit_type)
        elif Units(store).exists(session.unit):
            known = UnitTypes(store).of_unit(session.unit)
    if known is None:
        return judged_by_defaults(session, asked)
    usual = None if asked.minutes else usual_length(storage, session.unit, known.name)
    return _asked(session, asked, known.name, tolerances_of(known), usual)


def usual_length(storage: Storage, serial: str, unit_type: str) -> float | None:
    """Duration of the last session of the unit, or else of its type, s; None where none states it."""
    try:
        last = earlier(storage, serial, unit_type)
    except (NotFoundError, SessionError):
        return None
    return None if last is None or last.time is None else float(np.ptp(last.time)) or None


def _asked(
    session: CalibrationSession,
    asked: ReadyQuestion,
    unit_type: str | None,
    tolerances: dict[tuple[str, str], float],
    usual: float | None,
) -> Asked:
    kind = leading_kind({sensor.kind for sensor in session.sensors})
    question = asked.question(kind, tolerances, usual)
    found = readiness(session, question, np.random.default_rng(SEED))
    return Asked(found, kind, unit_type, asked.minutes is None and usual is None)
