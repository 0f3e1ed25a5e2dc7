"""Flow: an engineer chooses and approves the session that the others of its epoch are judged against."""

from estimator.session import IN_SERVICE
from service.errors import ConflictError
from service.flows.derive_again import Derived, Deriving, derive_again
from service.flows.follow import follow
from service.records.session import StoredSession
from service.records.state import RecordState, Step
from service.storage import Storage
from service.storage.store import Store
from service.words.advice import too_few


def choose_reference(storage: Storage, way: Deriving, id: str, step: Step) -> tuple[StoredSession, Derived]:
    """Makes a session the reference of its epoch, from the first session on; ConflictError where it cannot be one."""
    with storage.database.writing() as store:
        unit = store.units.hold(store.sessions.get(id).unit)
        session = store.sessions.get(id)
        _require_possible(store, session)
        store.states.choose(unit, id, step)
        store.audit.write(step.at, step.who, "choose reference", id, {"unit": session.unit, "why": step.why})
        derived = derive_again(store, way, session.unit, session.started_at, (id,))
    follow(storage, way, session.unit, derived)
    with storage.database.reading() as store:
        return store.sessions.get(id), derived


def _require_possible(store: Store, session: StoredSession) -> None:
    if session.state is not RecordState.ACCEPTED:
        raise ConflictError(f"Session {session.id} is {session.state}: only an accepted session can be a reference.")
    if session.programme == IN_SERVICE:
        raise ConflictError("A recording in service is compared with a calibration and is no reference itself.")
    if blind := too_few(store.calibrations.get(session.id)):
        raise ConflictError(f"Session {session.id} gives no uncertainty to judge others with. {blind}")
