"""Flow: a known break in a unit's history; the first session measured after it is the new reference, whenever either
was entered."""

from datetime import datetime

from estimator.errors import Problem
from service.errors import RefusedError
from service.flows.derive_again import Derived, Deriving, derive_again
from service.flows.follow import follow
from service.ingest.checked import CLOCK_LEEWAY
from service.records.event import NewService, Service
from service.records.state import RecordKind, RecordState, Step
from service.storage import Storage
from service.storage.store import Store


def record_service(
    storage: Storage, serial: str, new: NewService, now: datetime, *, coverage_factor: float = 2.0
) -> tuple[Service, Derived | None]:
    """Records a break once; returns it and what followed, None where it was known. A trend never runs across it.

    One that was withdrawn and is recorded again counts again.
    """
    way = Deriving(storage.files, coverage_factor, now)
    with storage.database.writing() as store:
        unit = store.units.hold(serial)
        problems = _problems(store, serial, new, now)
        if problems:
            raise RefusedError("The service cannot be recorded.", problems)
        number, created = store.services.add(unit, new, now)
        known = store.services.get(number)
        if not created and known.state is RecordState.ACCEPTED:
            return known, None
        who = new.who or "crew"
        if not created:
            store.services.put_state(number, RecordState.ACCEPTED)
            step = Step(who, now, new.note or "recorded again")
            store.states.add(RecordKind.SERVICE, str(number), RecordState.ACCEPTED, step)
        details = {"kind": new.kind, "at": new.at.isoformat(), "note": new.note, "sensor": new.sensor}
        store.audit.write(now, who, "service", serial, details)
        derived = derive_again(store, way, serial, new.at)
        recorded = store.services.get(number)
    follow(storage, way, serial, derived)
    return recorded, derived


def _problems(store: Store, serial: str, new: NewService, now: datetime) -> tuple[Problem, ...]:
    found = []
    if new.at > now + CLOCK_LEEWAY:
        found.append(Problem("at", f"lies in the future ({new.at:%Y-%m-%d}); record what was done"))
    sensors = store.unit_types.of_unit(serial).sensors
    if new.sensor and new.sensor not in sensors:
        found.append(Problem("sensor", f"is no sensor of {serial}; it has {', '.join(sensors)}"))
    return tuple(found)
