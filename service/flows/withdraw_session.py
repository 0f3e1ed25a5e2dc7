"""Flow: a session is taken back: it stays readable, and nothing that is known of its unit rests on it any more."""

from service.errors import ConflictError
from service.flows.change_state import change
from service.flows.derive_again import Derived, Deriving, derive_again
from service.flows.follow import follow
from service.records.session import StoredSession
from service.records.state import RecordState, Step
from service.storage import Storage

POSSIBLE = (RecordState.ACCEPTED, RecordState.QUESTIONED)
"""States of a session that can be withdrawn."""


def withdraw_session(storage: Storage, way: Deriving, id: str, step: Step) -> tuple[StoredSession, Derived]:
    """Withdraws a session; ConflictError where it does not count any more."""
    with storage.database.writing() as store:
        store.units.hold(store.sessions.get(id).unit)
        session = store.sessions.get(id)
        if session.state not in POSSIBLE:
            raise ConflictError(f"Session {id} is {session.state} already.")
        change(store, session, RecordState.WITHDRAWN, step)
        derived = derive_again(store, way, session.unit, session.started_at, (id,))
    follow(storage, way, session.unit, derived)
    with storage.database.reading() as store:
        return store.sessions.get(id), derived
