"""Flow: an engineer says that a session counts: one that was questioned or taken back, or that gave way to another."""

from service.errors import ConflictError
from service.flows.change_state import change
from service.flows.derive_again import Derived, Deriving, derive_again
from service.flows.follow import follow
from service.records.session import StoredSession
from service.records.state import RecordState, Step
from service.storage import Storage
from service.storage.store import Store


def accept_session(storage: Storage, way: Deriving, id: str, step: Step) -> tuple[StoredSession, Derived]:
    """Accepts a session; ConflictError where it counts already, or where another one stands for it."""
    with storage.database.writing() as store:
        store.units.hold(store.sessions.get(id).unit)
        session = store.sessions.get(id)
        _require_possible(store, session)
        change(store, session, RecordState.ACCEPTED, step)
        derived = derive_again(store, way, session.unit, session.started_at, (id,))
    follow(storage, way, session.unit, derived)
    with storage.database.reading() as store:
        return store.sessions.get(id), derived


def _require_possible(store: Store, session: StoredSession) -> None:
    if session.state is RecordState.ACCEPTED:
        raise ConflictError(f"Session {session.id} is accepted already.")
    if session.simulated and not store.units.is_simulated(session.unit):
        raise ConflictError(f"Session {session.id} is simulated, and unit {session.unit} has been measured since.")
    if session.superseded_by is None:
        return
    stands_for_it = store.sessions.get(session.superseded_by)
    if stands_for_it.state in (RecordState.ACCEPTED, RecordState.QUESTIONED):
        raise ConflictError(
            f"Session {stands_for_it.id} stands for session {session.id}: withdraw it first, or both would count."
        )
