"""May a unit be used? By its latest judged session, or by a sound reference that nothing was held against yet, by its
due date and its open flags; in doubt it may not.
"""

from collections.abc import Iterator
from datetime import datetime, timedelta

from estimator.message import joined, say
from estimator.session import CALIBRATIONS
from service.flags.records import Flag, Matter
from service.flags.store import Flags
from service.fleet.records import Usable
from service.judging.reference import left_uncertain
from service.kit.failure import session_failed, unit_failed
from service.kit.measures import COVERAGE, day_of
from service.pages.unit import usable_words as words
from service.pages.unit.report import UnitReport, unit_report
from service.papers.certified import traceability_of
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.sessions.calibrations_store import Calibrations
from service.sessions.decision import Verdict
from service.sessions.records import StoredSession
from service.sessions.states import RecordState
from service.storage.queries import Store
from service.types.rules import tolerances_of
from service.units.store import Units

FIT = (Verdict.PASS, Verdict.CONDITIONAL_PASS)
"""Verdicts that a unit may be used with; the second with a reservation."""
FORBIDDING = (Matter.TOLERANCE,)
"""Flags that forbid the use until they are resolved, acknowledged or not: others are reservations. That a calibration
is overdue is asked of the clock, because its flag is raised once an hour only."""
MATTERS = tuple(Matter)
MOST_NAMED = 4
"""Parameters, by name, before the rest are counted."""
SLACK = timedelta(days=1)
"""A clock may be in another zone than it says."""


def usable(store: Store, serial: str, now: datetime) -> Usable:
    """The answer for one unit; NotFoundError when there is none of that serial number."""
    report = unit_report(store, serial, now)
    flags = tuple(sorted(Flags(store).open_of(Units(store).key(serial)), key=_gravity))
    session, since = _latest_judged(report, now), _last_service(report, now)
    reference = _reference(report, since) if session is None else None
    told = session or reference
    coarse = () if reference is None else _left_uncertain(store, report, reference)
    against = (*coarse, *_against(report, told, flags, now))
    undated = (_undated(report),) if report.summary.is_undated or report.summary.failed else ()
    return Usable(
        usable=not against,
        why=against[0] if against else _yes(report, session, _at(told)),
        reasons=against,
        reservations=(*_unproven(reference), *_reservations(store, told, flags), *_waiting(report, told), *undated),
        until=report.summary.due,
        verdict=None if session is None else session.verdict,
        session=None if session is None else session.id,
        correction=_correction(report, since),
        as_of=now,
    )


def _gravity(flag: Flag) -> tuple[int, int, str]:
    """The gravest flag first, whichever was raised first."""
    return MATTERS.index(flag.matter), -flag.severity, flag.place


def _last_service(report: UnitReport, now: datetime) -> datetime | None:
    return max((service.at for service in report.services if service.at <= now), default=None)


def _latest_judged(report: UnitReport, now: datetime) -> StoredSession | None:
    """The latest session that was held against a reference, since the last service."""
    since = _last_service(report, now)
    return next((s for s in _accepted(report, since) if not s.is_reference), None)


def _reference(report: UnitReport, since: datetime | None) -> StoredSession | None:
    """The reference calibration since the last service, against which nothing was held yet."""
    return next((s for s in _accepted(report, since) if s.is_reference and s.programme in CALIBRATIONS), None)


def _left_uncertain(store: Store, report: UnitReport, reference: StoredSession) -> Iterator[str]:
    """That a reference tells too little to be used by itself."""
    found = tuple(left_uncertain(Calibrations(store).get(reference.id), tolerances_of(report.unit_type), COVERAGE))
    if found:
        more = say(" and {most_named} more", most_named=len(found) - MOST_NAMED) if len(found) > MOST_NAMED else ""
        yield words.on(words.TOO_COARSE, reference.started_at, what=joined(", ", found[:MOST_NAMED]) + more)


def _yes(report: UnitReport, session: StoredSession | None, at: datetime) -> str:
    return words.on(words.BY_REFERENCE if session is None else words.YES, at, due=_day(report.summary.due))


def _unproven(reference: StoredSession | None) -> Iterator[str]:
    if reference is not None:
        yield words.on(words.UNPROVEN, reference.started_at)


def _correction(report: UnitReport, since: datetime | None) -> str | None:
    """The latest calibration of every sensor since the last service."""
    return next((s.id for s in _accepted(report, since) if s.programme in CALIBRATIONS), None)


def _accepted(report: UnitReport, since: datetime | None) -> Iterator[StoredSession]:
    """Sessions that count since a service, the latest first."""
    for session in report.sessions:
        if session.state is RecordState.ACCEPTED and (since is None or session.started_at >= since):
            yield session


def _against(
    report: UnitReport, session: StoredSession | None, flags: tuple[Flag, ...], now: datetime
) -> Iterator[str]:
    """Everything that forbids the use, the gravest first."""
    if session is None:
        yield _nothing_judged(report, now)
    else:
        yield from _of_session(session, now)
    yield from (words.flagged(flag) for flag in flags if flag.matter in FORBIDDING)
    due = report.summary.due
    if due is not None and due < now:
        yield say(words.OVERDUE, due=day_of(due), reason=report.summary.due_reason)
    elif due is None and session is not None and (session.is_reference or session.verdict in FIT):
        yield _undated(report) if report.summary.is_undated or report.summary.failed else words.NO_DUE


def _undated(report: UnitReport) -> str:
    return unit_failed(report.summary.failed) if report.summary.failed else words.DATES_PENDING


def _nothing_judged(report: UnitReport, now: datetime) -> str:
    since = _last_service(report, now)
    if since is not None:
        return words.on(words.SINCE_SERVICE, since)
    return words.NOTHING_JUDGED if report.sessions else words.NO_SESSION


def _of_session(session: StoredSession, now: datetime) -> Iterator[str]:
    at = session.started_at
    if session.verdict is Verdict.UNDECIDABLE and not session.is_reference:
        yield words.on(words.UNDECIDED, at, reason=session.reason)
    elif session.verdict not in FIT and not session.is_reference:
        yield words.on(words.NOT_FIT, at, reason=session.reason)
    if at > now + SLACK:
        yield words.on(words.FUTURE, at)


def _reservations(store: Store, session: StoredSession | None, flags: tuple[Flag, ...]) -> Iterator[str]:
    """What does not forbid the use, but must be known."""
    if session is not None:
        if session.verdict is Verdict.CONDITIONAL_PASS:
            yield say(words.CLOSE, reason=session.reason)
        chain = traceability_of(store, session)
        if chain.has_expired:
            yield chain.text
        if session.reservations is None:
            failed = WorkQueue(store, WorkKind.DIAGNOSIS).failed(session.id)
            yield session_failed(failed) if failed else words.on(words.NOT_DIAGNOSED, session.started_at)
        yield from (words.reserved(one) for one in session.reservations or ())
    yield from (words.flagged(flag) for flag in flags if flag.matter not in (*FORBIDDING, Matter.OVERDUE))


def _waiting(report: UnitReport, session: StoredSession | None) -> Iterator[str]:
    """Later sessions that wait for an engineer: what they may show does not count yet."""
    for later in report.sessions:
        is_later = session is None or later.started_at > session.started_at
        if is_later and later.state is RecordState.QUESTIONED:
            yield words.on(words.WAITS, later.started_at)


def _at(session: StoredSession | None) -> datetime:
    """Of a session that must be there: without one something speaks against the use."""
    assert session is not None
    return session.started_at


def _day(due: datetime | None) -> str:
    assert due is not None
    return day_of(due)
