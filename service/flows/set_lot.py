"""Flow: the production lot of a unit, so that a lot that drifts unlike the others can be seen."""

from datetime import datetime

from service.errors import NotFoundError
from service.flows.summarise import ask_for_summaries
from service.records.unit import UnitSummary
from service.storage import Storage


def set_lot(storage: Storage, serial: str, lot: str | None, now: datetime, *, who: str = "crew") -> UnitSummary:
    """Records the lot, or that none is known; the same one again changes nothing."""
    with storage.database.writing() as store:
        store.units.hold(serial)
        was = store.units.set_lot(serial, lot)
        if was != lot:
            ask_for_summaries(store, serial, now)
            store.audit.write(now, who, "lot", serial, {"before": was, "lot": lot})
        found = store.fleet.unit(serial)
    if found is None:
        raise NotFoundError(f"There is no unit {serial!r}.")
    return found
