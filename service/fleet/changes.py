"""Flow: how the units of a type drift, or how stands stand, made again in the background after a change of records."""

from datetime import datetime

from service.groups.records import Group, Level
from service.groups.store import Groups
from service.outlook.rules.populations import populations
from service.outlook.store import Outlooks, Populations
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.stands.health import stand_health
from service.stands.store import Stands
from service.storage import Storage
from service.storage.queries import Store
from service.types.store import UnitTypes


def summarise(storage: Storage, place: str, now: datetime) -> None:
    """Makes what pages read of a type or of the stands; what changes meanwhile has asked for it again."""
    with storage.database.reading() as store:
        group = Groups(store).at(place)
    if group.level is Level.STAND:
        _stands(storage, now)
    else:
        _type(storage, group, now)


def summarise_all(storage: Storage, now: datetime) -> int:
    """Makes all that is asked for; returns how many."""
    count = 0
    while True:
        with storage.database.reading() as store:
            found = WorkQueue(store, WorkKind.SUMMARY).waiting(now, 1)
        if not found:
            return count
        summarise(storage, found[0], now)
        count += 1


def ask_for_summaries(store: Store, serial: str, now: datetime) -> None:
    """Asks for the summaries of a unit's type and of its stands after a change of its records."""
    shared = (group.place for group in Groups(store).of_unit(serial) if group.level is not Level.UNIT)
    WorkQueue(store, WorkKind.SUMMARY).enqueue_each(shared, now)


def _type(storage: Storage, group: Group, now: datetime) -> None:
    with storage.database.reading() as store:
        asked, rates = WorkQueue(store, WorkKind.SUMMARY).tickets(group.place), Outlooks(store).rates(group.key)
    found = populations(rates)
    with storage.database.writing() as store:
        UnitTypes(store).hold(group.name)
        Populations(store).put(group.key, found, now)
        WorkQueue(store, WorkKind.SUMMARY).settle_each(asked)


def _stands(storage: Storage, now: datetime) -> None:
    """All together: a shift of one is recognised by the others."""
    with storage.database.reading() as store:
        asked, found = WorkQueue(store, WorkKind.SUMMARY).tickets_under(f"{Level.STAND} "), stand_health(store)
    with storage.database.writing() as store:
        Stands(store).put_conditions(found, now)
        WorkQueue(store, WorkKind.SUMMARY).settle_each(asked)
