"""Flow: for whom a unit is calibrated, as its certificates name them."""

from datetime import datetime

from service.records.paper import Customer
from service.storage import Storage


def set_customer(storage: Storage, serial: str, new: Customer, now: datetime, *, who: str = "crew") -> Customer:
    """Records the customer, or with empty texts that none is known; the same one again changes nothing."""
    with storage.database.writing() as store:
        store.units.hold(serial)
        before = store.units.customer(serial)
        if before != new:
            store.units.set_customer(serial, new)
            store.audit.write(now, who, "customer", serial, {"before": vars(before), "customer": vars(new)})
    return new
