"""Flow: a known break in a unit's history; the next session measured after it becomes the new reference."""

from datetime import datetime

from estimator.errors import Problem
from service.errors import RefusedError
from service.flows.refresh_outlook import refresh_outlook
from service.ingest.checked import CLOCK_LEEWAY
from service.records.event import NewService, Service
from service.storage import Storage
from service.storage.store import Store


def record_service(storage: Storage, serial: str, new: NewService, now: datetime) -> tuple[Service, bool]:
    """Records a break once, and returns it and whether it is new; a trend never runs across it."""
    with storage.database.writing() as store:
        unit = store.units.hold(serial)
        problems = _problems(store, serial, new, now)
        if problems:
            raise RefusedError("The service cannot be recorded.", problems)
        number, created = store.services.add(unit, new, now)
        if created:
            refresh_outlook(store, serial)
            details = {"kind": new.kind, "at": new.at.isoformat(), "note": new.note, "sensor": new.sensor}
            store.log.audit(now, new.who or "crew", "service", serial, details)
        return store.services.get(number), created


def _problems(store: Store, serial: str, new: NewService, now: datetime) -> tuple[Problem, ...]:
    found = []
    if new.at > now + CLOCK_LEEWAY:
        found.append(Problem("at", f"lies in the future ({new.at:%Y-%m-%d}); record what was done"))
    sensors = store.unit_types.of_unit(serial).sensors
    if new.sensor and new.sensor not in sensors:
        found.append(Problem("sensor", f"is no sensor of {serial}; it has {', '.join(sensors)}"))
    return tuple(found)
