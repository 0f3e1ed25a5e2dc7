"""Flow: a known break in a unit's history; the next session measured after it becomes the new reference."""

from datetime import datetime

from estimator.errors import Problem
from service.errors import RefusedError
from service.flows.outlook import refresh_outlook
from service.flows.storable import CLOCK_LEEWAY
from service.records import Service
from service.storage import Storage

KINDS = ("adjustment", "repair", "sensor swap", "new reference")


def record_service(
    storage: Storage, serial: str, kind: str, at: datetime, note: str, now: datetime, *, who: str = "crew"
) -> tuple[Service, bool]:
    """Records a break once, and returns it and whether it is new; a trend never runs across it."""
    if at > now + CLOCK_LEEWAY:
        message = f"lies in the future ({at:%Y-%m-%d}); record what was done"
        raise RefusedError("The service cannot be recorded.", (Problem("at", message),))
    with storage.database.writing() as store:
        unit = store.units.hold(serial)
        number, created = store.services.add(unit, kind, at, note, now)
        if created:
            refresh_outlook(store, serial)
            store.log.audit(now, who, "service", serial, {"kind": kind, "at": at.isoformat(), "note": note})
        return store.services.get(number), created
