"""Permitted use of units, by their serial numbers."""

from collections.abc import Collection, Sequence
from datetime import datetime

from service.flags.records import Matter
from service.fleet.condition import UnitSummary
from service.fleet.store import Fleet
from service.judging.records import Usable, UseFacts
from service.judging.usable import usable
from service.judging.usable_store import UseStore
from service.outlook.changes import END_OF_TIME
from service.storage import Storage
from service.storage.queries import Store

AT_A_TIME = 1000
"""Units that one question to the database names."""


AT_ONCE = 100
"""Units whose use is settled in one transaction."""


def usable_of(store: Store, units: Sequence[UnitSummary], now: datetime) -> dict[str, Usable]:
    """The permitted use of units, by serial number."""
    found: dict[str, Usable] = {}
    for start in range(0, max(len(units), 1), AT_A_TIME):
        facts = UseStore(store).facts(units[start : start + AT_A_TIME], now)
        found |= {unit_facts.unit.serial: usable(unit_facts, now) for unit_facts in facts}
    return found


def settle_uses(store: Store, units: Collection[int]) -> None:
    """Stores the permitted use of units up to their due date, or, where a flag marks a unit as overdue, after it."""
    found, known = UseStore(store), Fleet(store).by_keys(units)
    facts = found.facts([summary for summary, _ in known.values()], END_OF_TIME)
    found.put(
        {
            key: (usable(of_unit, _moment(of_unit)), is_listed)
            for (key, (_, is_listed)), of_unit in zip(known.items(), facts, strict=True)
        }
    )


def _moment(known: UseFacts) -> datetime:
    is_overdue = any(flag.matter is Matter.OVERDUE for flag in known.flags)
    return END_OF_TIME if is_overdue or known.unit.due is None else known.unit.due


def settle_all(storage: Storage) -> None:
    """Stores the permitted use of every unit, a few in each transaction: after an upgrade, and against anything
    forgotten.
    """
    after: int | None = 0
    while after is not None:
        with storage.database.writing() as store:
            after = UseStore(store).touch_next(after, AT_ONCE)


def usable_unit(store: Store, serial: str, now: datetime) -> Usable:
    """The permitted use of one unit; NotFoundError where there is none of that serial number."""
    unit = Fleet(store).get(serial)
    return usable_of(store, (unit,), now)[serial]
