"""Whether a unit is warm and still enough, by the first minutes of a record; nothing is stored."""

from dataclasses import dataclass

import numpy as np

from estimator.errors import SessionError
from estimator.readiness import Readiness, readiness
from estimator.session import CalibrationSession
from service.errors import NotFoundError, RefusedError
from service.ingest import in_turn, read_first_rows
from service.ingest.layout.envelope import wrapped
from service.judging.tolerances import DEFAULTS, tolerances_of
from service.measures import leading_kind
from service.planning.ready import ReadyQuestion
from service.records.received import SentFile, held, where
from service.records.session import PARAMETERS
from service.storage import Storage
from service.views.pattern import earlier

SEED = 1
"""Of the draws: the same file has the same answer."""


@dataclass(frozen=True)
class Asked:
    """The answer, and what it was judged by."""

    found: Readiness
    kind: str
    """Of the leading sensors."""
    unit_type: str | None
    """Whose tolerances were taken; None: the defaults."""
    is_usual: bool
    """Whether the duration was nobody's, but the usual one."""


def readiness_of(storage: Storage, file: SentFile, asked: ReadyQuestion) -> Asked:
    """Ready or not; RefusedError with every problem where the file cannot be read."""
    content = where(file.content) if file.mapping is None else wrapped(file.mapping, held(file.content))
    try:
        with in_turn(content):
            return _answered(storage, read_first_rows(content, file.filename), asked)
    except SessionError as fault:
        raise RefusedError(f"{file.filename} cannot be read so far.", fault.problems) from fault


def judged_by_defaults(session: CalibrationSession, asked: ReadyQuestion) -> Asked:
    """The same without a store, as of a unit that nobody knows."""
    return _asked(session, asked, None, defaults(), None)


def defaults() -> dict[tuple[str, str], float]:
    """The tolerances that hold until an engineer sets others."""
    stated = {(kind, name): getattr(own, name) for kind, own in DEFAULTS.items() for name in PARAMETERS}
    return {key: tolerance for key, tolerance in stated.items() if tolerance is not None}


def _answered(storage: Storage, session: CalibrationSession, asked: ReadyQuestion) -> Asked:
    known = None
    with storage.database.reading() as store:
        if asked.unit_type:
            known = store.unit_types.get(asked.unit_type)
        elif store.units.exists(session.unit):
            known = store.unit_types.of_unit(session.unit)
    if known is None:
        return judged_by_defaults(session, asked)
    usual = None if asked.minutes else usual_length(storage, session.unit, known.name)
    return _asked(session, asked, known.name, tolerances_of(known), usual)


def usual_length(storage: Storage, serial: str, unit_type: str) -> float | None:
    """s that the last session of the unit, or else of its type, took; None where none says so."""
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
