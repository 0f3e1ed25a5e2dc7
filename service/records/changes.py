"""Records are accepted, withdrawn, marked and chosen; services are recorded and withdrawn."""

from datetime import datetime

from estimator.errors import problem_at
from estimator.message import joined
from estimator.session import IN_SERVICE
from service.diagnosis.records import Diagnosed
from service.errors import ConflictError, RefusedError
from service.ingest.checked import CLOCK_LEEWAY
from service.judging.records import Decided
from service.judging.store import Derivations
from service.outlook.changes import END_OF_TIME
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.records.derive_again import Derived, Deriving, derive_again
from service.records.flagging.acts import SERVICE
from service.records.follow import follow
from service.sessions.calibrations_store import Calibrations
from service.sessions.decision import Judged
from service.sessions.doubt import Remedies
from service.sessions.records import MARKS, StoredSession
from service.sessions.states import RecordKind, RecordState, Step
from service.sessions.states_store import States
from service.sessions.store import NOT_JUDGED, Sessions
from service.sessions.words.advice import too_few
from service.storage import Storage
from service.storage.audit import Audit
from service.storage.queries import Store
from service.types.store import UnitTypes
from service.units.records import NewService, Service
from service.units.store import Services, Units

DONE = {
    RecordState.ACCEPTED: "accept session",
    RecordState.QUESTIONED: "question session",
    RecordState.WITHDRAWN: "withdraw session",
    RecordState.SUPERSEDED: "supersede session",
}
"""Names of the changes in the audit trail."""


def change(
    store: Store,
    session: StoredSession,
    state: RecordState,
    step: Step,
    *,
    superseded_by: str | None = None,
    remedies: Remedies | None = None,
) -> None:
    """Writes down what becomes of a session, by whom and why; what follows from it is derived afterwards."""
    if state is RecordState.ACCEPTED and _was_questioned(store, session.id):
        WorkQueue(store, WorkKind.DIAGNOSIS).enqueue_once(Derivations(store).forget_diagnosis(session.id), step.at)
    States(store).put_session(session.id, state, superseded_by)
    States(store).add(RecordKind.SESSION, session.id, state, step, superseded_by=superseded_by, remedies=remedies)
    details = {"unit": session.unit, "before": session.state.value, "why": step.why, "superseded_by": superseded_by}
    Audit(store).write(step.at, step.who, DONE[state], session.id, details)


def _was_questioned(store: Store, id: str) -> bool:
    return any(line.state is RecordState.QUESTIONED for line in States(store).of(RecordKind.SESSION, id))


OTHERWISE_WRITTEN = ("channels-swapped", "sign-reversed", "runs-swapped", "beta-reversed", "positions-swapped")
"""Causes by which a file states something else than was done."""
QUESTIONED = "Questioned, not judged: "
"""Heads the reason."""
NOTHING_KNOWN = Remedies()
"""Remedies where none is known."""


def question(
    store: Store, context: Deriving, session: StoredSession, why: str, remedies: Remedies = NOTHING_KNOWN
) -> None:
    """Takes a stored session out of what counts, and says why before everything else, and what would put it right."""
    change(store, session, RecordState.QUESTIONED, Step(SERVICE, context.at, why), remedies=remedies)
    unjudged = Judged(Calibrations(store).get(session.id), (), QUESTIONED + why, is_reference=False)
    Derivations(store).put_judged((Decided(session.id, session.revision, unjudged, NOT_JUDGED, None),))


def question_diagnosed(store: Store, context: Deriving, id: str, found: Diagnosed) -> Derived | None:
    """Questions an accepted session whose diagnosis finds that its file states something else than was done.

    One that an engineer accepted stays accepted. Returns the remaining derivations; None where nothing changed.
    """
    named = [finding for finding in found.findings if finding.cause in OTHERWISE_WRITTEN]
    session = Sessions(store).get(id)
    if not named or session.state is not RecordState.ACCEPTED or States(store).of(RecordKind.SESSION, id):
        return None
    question(store, context, session, joined(" ", (finding.sentence for finding in named)))
    return derive_again(store, context, session.unit, session.started_at, (id,))


def accept_session(storage: Storage, context: Deriving, id: str, step: Step) -> tuple[StoredSession, Derived]:
    """Accepts a session; ConflictError where it counts already, or where another has superseded it."""
    with storage.database.writing() as store:
        Units(store).hold(Sessions(store).get(id).unit)
        session = Sessions(store).get(id)
        _require_possible(store, session)
        change(store, session, RecordState.ACCEPTED, step)
        derived = derive_again(store, context, session.unit, session.started_at, (id,))
    follow(storage, context, session.unit, derived)
    with storage.database.reading() as store:
        return Sessions(store).get(id), derived


def _require_possible(store: Store, session: StoredSession) -> None:
    if session.state is RecordState.ACCEPTED:
        raise ConflictError("Session {id} is accepted already.", id=session.id)
    if session.simulated and not Units(store).is_simulated(session.unit):
        raise ConflictError(
            "Session {id} is simulated, and unit {unit} has been measured since.", id=session.id, unit=session.unit
        )
    if session.superseded_by is None:
        return
    stands_for_it = Sessions(store).get(session.superseded_by)
    if stands_for_it.state in (RecordState.ACCEPTED, RecordState.QUESTIONED):
        parts = {"id": stands_for_it.id, "id2": session.id}
        raise ConflictError("Session {id} replaces session {id2}: withdraw it first, or both would count.", **parts)


POSSIBLE = (RecordState.ACCEPTED, RecordState.QUESTIONED)
"""States of a session that can be withdrawn."""


def withdraw_session(storage: Storage, context: Deriving, id: str, step: Step) -> tuple[StoredSession, Derived]:
    """Withdraws a session; ConflictError where it does not count any more."""
    with storage.database.writing() as store:
        Units(store).hold(Sessions(store).get(id).unit)
        session = Sessions(store).get(id)
        if session.state not in POSSIBLE:
            raise ConflictError("Session {id} is {state} already.", id=id, state=session.state)
        change(store, session, RecordState.WITHDRAWN, step)
        derived = derive_again(store, context, session.unit, session.started_at, (id,))
    follow(storage, context, session.unit, derived)
    with storage.database.reading() as store:
        return Sessions(store).get(id), derived


def choose_reference(storage: Storage, context: Deriving, id: str, step: Step) -> tuple[StoredSession, Derived]:
    """Makes a session the reference of its epoch, from the first session on; ConflictError where it cannot be one."""
    with storage.database.writing() as store:
        unit = Units(store).hold(Sessions(store).get(id).unit)
        session = Sessions(store).get(id)
        _require_choice(store, session)
        States(store).choose(unit, id, step)
        Audit(store).write(step.at, step.who, "choose reference", id, {"unit": session.unit, "why": step.why})
        derived = derive_again(store, context, session.unit, session.started_at, (id,))
    follow(storage, context, session.unit, derived)
    with storage.database.reading() as store:
        return Sessions(store).get(id), derived


def _require_choice(store: Store, session: StoredSession) -> None:
    if session.state is not RecordState.ACCEPTED:
        parts = {"id": session.id, "state": session.state}
        raise ConflictError("Session {id} is {state}: only an accepted session can be a reference.", **parts)
    if session.programme == IN_SERVICE:
        raise ConflictError("A recording in service is compared with a calibration and is no reference itself.")
    if blind := too_few(Calibrations(store).get(session.id)):
        raise ConflictError(
            "Session {id} has no uncertainty, so no session can be judged against it. {advice}",
            id=session.id,
            advice=blind,
        )


def set_mark(storage: Storage, context: Deriving, id: str, step: Step, word: str, *, is_so: bool) -> StoredSession:
    """Marks a session and works out its unit's dates again; no verdict changes. The same mark again changes nothing."""
    derived: Derived | None = None
    with storage.database.writing() as store:
        Units(store).hold(Sessions(store).get(id).unit)
        session = Sessions(store).get(id)
        if (word in session.words) != is_so:
            Sessions(store).mark(id, **{MARKS[word]: is_so})
            details = {"unit": session.unit, MARKS[word]: is_so, "why": step.why}
            Audit(store).write(step.at, step.who, word, id, details)
            derived = derive_again(store, context, session.unit, END_OF_TIME)
    if derived is not None:
        follow(storage, context, session.unit, derived)
    with storage.database.reading() as store:
        return Sessions(store).get(id)


def set_stage(storage: Storage, id: str, stage: str | None, who: str, now: datetime) -> StoredSession:
    """Marks a session; the same mark again changes nothing."""
    with storage.database.writing() as store:
        session = Sessions(store).get(id)
        if session.stage != stage:
            Sessions(store).mark(id, stage=stage)
            Audit(store).write(now, who, "stage", id, {"unit": session.unit, "before": session.stage, "stage": stage})
        return Sessions(store).get(id)


def record_service(
    storage: Storage, serial: str, new: NewService, now: datetime, *, coverage_factor: float = 2.0
) -> tuple[Service, Derived | None]:
    """Records a break once; returns it and what followed, None where it was known. A trend never runs across it.

    One that was withdrawn and is recorded again counts again.
    """
    context = Deriving(storage.files, coverage_factor, now)
    with storage.database.writing() as store:
        unit = Units(store).hold(serial)
        require_possible(store, serial, new, now)
        number, created = Services(store).add(unit, new, now)
        known = Services(store).get(number)
        if not created and known.state is RecordState.ACCEPTED:
            return known, None
        who = new.who or "crew"
        if not created:
            Services(store).put_state(number, RecordState.ACCEPTED)
            step = Step(who, now, new.note or "recorded again")
            States(store).add(RecordKind.SERVICE, str(number), RecordState.ACCEPTED, step)
        details = {"kind": new.kind, "at": new.at.isoformat(), "note": new.note, "sensor": new.sensor}
        Audit(store).write(now, who, "service", serial, details)
        derived = derive_again(store, context, serial, new.at)
        recorded = Services(store).get(number)
    follow(storage, context, serial, derived)
    return recorded, derived


def require_possible(store: Store, serial: str, new: NewService, now: datetime) -> None:
    """RefusedError for a service in the future or of an unknown sensor."""
    found = []
    if new.at > now + CLOCK_LEEWAY:
        found.append(problem_at("at", "is in the future ({at}); record what has been done", at=f"{new.at:%Y-%m-%d}"))
    sensors = UnitTypes(store).of_unit(serial).sensors
    if new.sensor and new.sensor not in sensors:
        found.append(
            problem_at(
                "sensor", "is not a sensor of {serial}; it has {sensors}", serial=serial, sensors=joined(", ", sensors)
            )
        )
    if found:
        raise RefusedError("The service cannot be recorded.", tuple(found))


def withdraw_service(storage: Storage, context: Deriving, number: int, step: Step) -> tuple[Service, Derived]:
    """Withdraws a service; ConflictError where that was done before."""
    with storage.database.writing() as store:
        Units(store).hold(Services(store).get(number).unit)
        service = Services(store).get(number)
        if service.state is RecordState.WITHDRAWN:
            raise ConflictError("Service {number} is withdrawn already.", number=number)
        Services(store).put_state(number, RecordState.WITHDRAWN)
        States(store).add(RecordKind.SERVICE, str(number), RecordState.WITHDRAWN, step)
        details = {"service": number, "kind": service.kind, "at": service.at.isoformat(), "why": step.why}
        Audit(store).write(step.at, step.who, "withdraw service", service.unit, details)
        derived = derive_again(store, context, service.unit, service.at)
        withdrawn = Services(store).get(number)
    follow(storage, context, withdrawn.unit, derived)
    return withdrawn, derived
