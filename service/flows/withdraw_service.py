"""Flow: a service is taken back: it was none, or not of this unit or date. It stays on record and is no break."""

from service.errors import ConflictError
from service.flows.derive_again import Derived, Deriving, derive_again
from service.flows.follow import follow
from service.records.event import Service
from service.records.state import RecordKind, RecordState, Step
from service.storage import Storage


def withdraw_service(storage: Storage, way: Deriving, number: int, step: Step) -> tuple[Service, Derived]:
    """Withdraws a service; ConflictError where that was done before."""
    with storage.database.writing() as store:
        store.units.hold(store.services.get(number).unit)
        service = store.services.get(number)
        if service.state is RecordState.WITHDRAWN:
            raise ConflictError(f"Service {number} is withdrawn already.")
        store.services.put_state(number, RecordState.WITHDRAWN)
        store.states.add(RecordKind.SERVICE, str(number), RecordState.WITHDRAWN, step)
        details = {"service": number, "kind": service.kind, "at": service.at.isoformat(), "why": step.why}
        store.audit.write(step.at, step.who, "withdraw service", service.unit, details)
        derived = derive_again(store, way, service.unit, service.at)
        withdrawn = store.services.get(number)
    follow(storage, way, withdrawn.unit, derived)
    return withdrawn, derived
