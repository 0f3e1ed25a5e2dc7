"""Flow: a session is said to be a check, which moves no date, or a calibration after all."""

from service.flows.derive_again import Derived, Deriving, derive_again
from service.flows.follow import follow
from service.flows.refresh_outlook import END_OF_TIME
from service.records.session import StoredSession
from service.records.state import Step
from service.storage import Storage


def set_check(storage: Storage, way: Deriving, id: str, step: Step, *, is_check: bool) -> StoredSession:
    """Marks a session and works out its unit's dates again; no verdict changes. The same mark again changes nothing."""
    derived: Derived | None = None
    with storage.database.writing() as store:
        store.units.hold(store.sessions.get(id).unit)
        session = store.sessions.get(id)
        if session.is_check != is_check:
            store.sessions.set_check(id, is_check)
            details = {"unit": session.unit, "is_check": is_check, "why": step.why}
            store.audit.write(step.at, step.who, "check", id, details)
            derived = derive_again(store, way, session.unit, END_OF_TIME)
    if derived is not None:
        follow(storage, way, session.unit, derived)
    with storage.database.reading() as store:
        return store.sessions.get(id)
