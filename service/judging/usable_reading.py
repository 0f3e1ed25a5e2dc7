"""What units may be used for, by their serial numbers."""

from collections.abc import Sequence
from datetime import datetime

from service.fleet.condition import UnitSummary
from service.fleet.store import Fleet
from service.judging.records import Usable
from service.judging.usable import usable
from service.judging.usable_store import UseStore
from service.storage.queries import Store

AT_A_TIME = 1000
"""Units that one question to the database names."""


def usable_of(store: Store, units: Sequence[UnitSummary], now: datetime) -> dict[str, Usable]:
    """Of units, by serial number."""
    found: dict[str, Usable] = {}
    for start in range(0, max(len(units), 1), AT_A_TIME):
        facts = UseStore(store).facts(units[start : start + AT_A_TIME], now)
        found |= {unit_facts.unit.serial: usable(unit_facts, now) for unit_facts in facts}
    return found


def usable_unit(store: Store, serial: str, now: datetime) -> Usable:
    """Of one; NotFoundError when there is none of that serial number."""
    unit = Fleet(store).get(serial)
    return usable_of(store, (unit,), now)[serial]
