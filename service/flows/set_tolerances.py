"""Flow: other tolerances for a unit type, from the next session on, and another longest calibration interval."""

from dataclasses import asdict
from datetime import datetime

from service.errors import ConflictError
from service.flows.derive_again import Deriving
from service.flows.refresh_beside import date
from service.measures import COVERAGE
from service.records.unit import Tolerances, UnitType
from service.records.work import WorkKind
from service.storage import Storage


def set_tolerances(
    storage: Storage,
    name: str,
    tolerances: Tolerances,
    gyro_tolerances: Tolerances | None,
    now: datetime,
    *,
    interval_days: float | None = None,
    who: str = "crew",
    why: str = "",
    seen: int | None = None,
) -> UnitType:
    """Adds a revision of the type's tolerances; the same ones again change nothing, and past decisions keep theirs.

    ConflictError where ``seen``, the revision that somebody changed, is no longer the one in force.

    Another interval holds for all units of the type at once; None leaves it as it is.
    """
    undated: tuple[str, ...] = ()
    with storage.database.writing() as store:
        current = store.unit_types.hold(name)
        if seen is not None and seen != current.revision:
            raise ConflictError(
                f"Somebody set other tolerances meanwhile, revision {current.revision}: look at them, then set yours."
            )
        said = {"why": why} if why else {}
        if interval_days is not None and interval_days != current.maximum_interval_days:
            was = current.maximum_interval_days
            current = store.unit_types.set_interval(name, interval_days)
            undated = tuple(store.units.of_type(name))
            for serial in undated:
                store.work(WorkKind.OUTLOOK).ask_again(serial, now)
            store.audit.write(
                now, who, "interval", name, {"before": was, "maximum_interval_days": interval_days} | said
            )
        if (current.tolerances, current.gyro_tolerances) != (tolerances, gyro_tolerances):
            before = asdict(current)
            current = store.unit_types.revise(name, tolerances, gyro_tolerances, now)
            store.audit.write(now, who, "tolerances", name, {"before": before, **asdict(current), **said})
    date(storage, Deriving(storage.files, COVERAGE, now), *undated)
    return current
