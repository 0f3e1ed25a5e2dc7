"""Flow: a session is superseded by another: a corrected file, the right unit, the right date. Both stay on record."""

from datetime import datetime

from estimator.errors import SessionError
from service.errors import ConflictError
from service.ingest import read_upload
from service.ingest.checked import as_checked
from service.judging.plausible import doubts
from service.judging.reference import known_unit
from service.records.changes import change
from service.records.derive_again import Derived, Deriving, derive_again
from service.records.follow import follow
from service.sessions.records import StoredSession
from service.sessions.sent import Replaced
from service.sessions.states import RecordKind, RecordState, Step
from service.sessions.states_store import States
from service.sessions.store import Sessions
from service.storage import Storage
from service.storage.files import LOST
from service.storage.queries import Store
from service.units.store import Units

REPLACEABLE = (RecordState.ACCEPTED, RecordState.QUESTIONED)
"""States of a session that another one can stand for."""


def supersede_session(
    storage: Storage, context: Deriving, replaced: Replaced, successor: str
) -> tuple[StoredSession, Derived]:
    """Marks a stored session as superseded by another; ConflictError where either does not count."""
    settled = settled_by(storage, replaced.session, successor)
    with storage.database.writing() as store:
        derived = supersede(store, context, replaced, Sessions(store).get(successor), settled)
    for serial, unit_derived in derived.items():
        follow(storage, context, serial, unit_derived)
    with storage.database.reading() as store:
        session = Sessions(store).get(replaced.session)
        return session, derived[session.unit]


def supersede(
    store: Store, context: Deriving, replaced: Replaced, successor: StoredSession, settled: str | None
) -> dict[str, Derived]:
    """Marks a session as superseded within a transaction, and derives the state of the units concerned.

    ``settled``: the doubt about the other session that this resolves, from `settled_by`.
    """
    is_settled = _is_in_doubt_for(store, successor, settled)
    known = give_way(store, context.at, replaced, successor)
    touched = (known.id, successor.id)
    if is_settled:
        change(store, successor, RecordState.ACCEPTED, Step(replaced.who, context.at, replaced.why))
    derived = {known.unit: derive_again(store, context, known.unit, known.started_at, touched)}
    if is_settled and successor.unit != known.unit:
        derived[successor.unit] = derive_again(store, context, successor.unit, successor.started_at, touched)
    return derived


def settled_by(storage: Storage, replaced: str, successor: str) -> str | None:
    """The only doubt about a questioned session, where it is that it holds the readings of the session which it
    supersedes now.
    """
    with storage.database.reading() as store:
        session = Sessions(store).get(successor)
    if session.state is not RecordState.QUESTIONED:
        return None
    try:
        source = read_upload(storage.files.content(session.sha256), session.filename)
    except (*LOST, SessionError):
        return None
    with storage.database.reading() as store:
        known = known_unit(store, Units(store).key(session.unit))
        found = doubts(
            known, as_checked(source, session.started_at, session.unit), known.calibration(successor), (successor,)
        )
    return found[0].text if [doubt.stands_for for doubt in found] == [replaced] else None


def _is_in_doubt_for(store: Store, session: StoredSession, why: str | None) -> bool:
    """Whether a session is questioned for a reason and no other."""
    if why is None or session.state is not RecordState.QUESTIONED:
        return False
    return States(store).of(RecordKind.SESSION, session.id)[-1].why == why


def give_way(store: Store, at: datetime, replaced: Replaced, successor: StoredSession) -> StoredSession:
    """Writes down that a session is superseded, and returns it as it was."""
    Units(store).hold(Sessions(store).get(replaced.session).unit)
    known = Sessions(store).get(replaced.session)
    if known.id == successor.id:
        raise ConflictError(
            "Session {id} cannot replace itself: the file contains what is already stored.", id=known.id
        )
    if known.state not in REPLACEABLE:
        raise ConflictError("Session {id} is already {state}: nothing replaces it.", id=known.id, state=known.state)
    if successor.state not in REPLACEABLE:
        raise ConflictError(
            "Session {id} is itself {state}: it replaces no other.", id=successor.id, state=successor.state
        )
    change(store, known, RecordState.SUPERSEDED, Step(replaced.who, at, replaced.why), superseded_by=successor.id)
    return known


def successor_of(storage: Storage, id: str) -> str:
    """The session that can only be meant as the corrected one: uploaded later, of the same unit, block and date."""
    with storage.database.reading() as store:
        known = Sessions(store).get(id)
        found = Sessions(store).corrected(known)
    if len(found) != 1:
        raise ConflictError(
            "It is not clear which session replaces {id}: name it in `superseded_by`. Uploaded later with the "
            "same unit and date: {number}.",
            id=id,
            number=len(found),
        )
    return found[0]
