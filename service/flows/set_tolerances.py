"""Flow: other tolerances for a unit type, from the next session on; past decisions keep theirs."""

from dataclasses import asdict
from datetime import datetime

from service.records import Tolerances, UnitType
from service.storage import Storage


def set_tolerances(
    storage: Storage,
    name: str,
    tolerances: Tolerances,
    gyro_tolerances: Tolerances | None,
    now: datetime,
    *,
    who: str = "crew",
) -> UnitType:
    """Adds a revision of the type's tolerances; the same ones again change nothing."""
    with storage.database.writing() as store:
        current = store.unit_types.hold(name)
        if (current.tolerances, current.gyro_tolerances) == (tolerances, gyro_tolerances):
            return current
        revised = store.unit_types.revise(name, tolerances, gyro_tolerances, now)
        store.log.audit(now, who, "tolerances", name, asdict(revised))
        return revised
