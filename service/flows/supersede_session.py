"""Flow: a session gives way to another one: a corrected file, the right unit, the right date. Both stay on record."""

from datetime import datetime

from estimator.errors import SessionError
from service.errors import ConflictError
from service.flows.change_state import change
from service.flows.derive_again import Derived, Deriving, derive_again
from service.flows.refresh_beside import date
from service.ingest import read_upload
from service.ingest.checked import as_checked
from service.judging.known_unit import known_unit
from service.judging.plausible import doubts
from service.records.received import Replaced
from service.records.session import StoredSession
from service.records.state import RecordKind, RecordState, Step
from service.storage import Storage
from service.storage.files import LOST
from service.storage.store import Store

REPLACEABLE = (RecordState.ACCEPTED, RecordState.QUESTIONED)
"""States of a session that another one can stand for."""


def supersede_session(storage: Storage, way: Deriving, replaced: Replaced, by: str) -> tuple[StoredSession, Derived]:
    """Says that a stored session stands for another one; ConflictError where either does not count."""
    with storage.database.writing() as store:
        derived = supersede(store, way, replaced, store.sessions.get(by))
        own, unit = store.sessions.get(replaced.session), store.sessions.get(by).unit
    date(storage, way, *{own.unit: 0, unit: 0})
    return own, derived


def supersede(store: Store, way: Deriving, replaced: Replaced, by: StoredSession) -> Derived:
    """The same within a transaction; derives what is known of the unit of the session that gives way."""
    is_settled = _is_settled(store, way, replaced.session, by)
    known = give_way(store, way.at, replaced, by)
    if is_settled:
        change(store, by, RecordState.ACCEPTED, Step(replaced.who, way.at, replaced.why))
    return derive_again(store, way, known.unit, known.started_at, (known.id, by.id))


def _is_settled(store: Store, way: Deriving, replaced: str, by: StoredSession) -> bool:
    """Whether a questioned session was in doubt for nothing but the session that it stands for now."""
    if by.state is not RecordState.QUESTIONED:
        return False
    try:
        source = read_upload(way.files.content(by.sha256), by.filename)
    except (*LOST, SessionError):
        return False
    known = known_unit(store, store.units.key(by.unit))
    found = doubts(known, as_checked(source, by.started_at, by.unit), known.calibration(by.id), (by.id,))
    asked = store.states.of(RecordKind.SESSION, by.id)[-1].why
    return [doubt.stands_for for doubt in found] == [replaced] and asked == found[0].text


def give_way(store: Store, at: datetime, replaced: Replaced, by: StoredSession) -> StoredSession:
    """Writes down that a session gives way to another, and returns it as it was."""
    store.units.hold(store.sessions.get(replaced.session).unit)
    known = store.sessions.get(replaced.session)
    if known.id == by.id:
        raise ConflictError(f"Session {known.id} cannot stand for itself: the file holds what is stored already.")
    if known.state not in REPLACEABLE:
        raise ConflictError(f"Session {known.id} is {known.state} already, so nothing stands for it.")
    if by.state not in REPLACEABLE:
        raise ConflictError(f"Session {by.id} is {by.state} itself, so it stands for none.")
    change(store, known, RecordState.SUPERSEDED, Step(replaced.who, at, replaced.why), superseded_by=by.id)
    return known


def successor_of(storage: Storage, id: str) -> str:
    """The session that can only be meant as the corrected one: uploaded later, of the same unit, block and date."""
    with storage.database.reading() as store:
        known = store.sessions.get(id)
        found = store.sessions.corrected(known)
    if len(found) != 1:
        raise ConflictError(
            f"Which session stands for {id} cannot be told: name it in `superseded_by`. "
            f"Uploaded later of the same unit and date: {len(found)}."
        )
    return found[0]
