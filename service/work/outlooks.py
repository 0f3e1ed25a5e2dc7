"""Outlooks of units whose history has changed, and of units whose type has told more since."""

from datetime import datetime

from service.fleet.store import Fleet
from service.kit.guard import Alone, plainly
from service.outlook.changes import digest, of_type
from service.outlook.store import Outlooks
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.records.refresh_outlooks import date_one
from service.storage import Storage
from service.storage.store import Store
from service.units.store import Units


def relearn(storage: Storage, now: datetime, alone: Alone = plainly) -> int:
    """Brings every outlook up to what its type tells by now, and returns how many that were.

    What a unit tells of its type does not depend on the type, so one round is enough, and the outlooks of a fleet do
    not depend on the order in which its sessions came; where no unit has told yet, after the store was brought up to
    date, it takes two.
    """
    with storage.database.reading() as store:
        serials = Units(store).every()
    done = 0
    for serial in serials:
        with alone("outlooks", serial):
            done += _relearned(storage, serial, now)
    return done


def _relearned(storage: Storage, serial: str, now: datetime) -> bool:
    with storage.database.reading() as store:
        if not _is_stale(store, serial):
            return False
    with storage.database.writing() as store:
        Units(store).hold(serial)
        WorkQueue(store, WorkKind.OUTLOOK).ask_again(serial, now)
    date_one(storage, serial, now)
    return True


def _is_stale(store: Store, serial: str) -> bool:
    """A unit of which no session is accepted has no outlook; one whose outlook is asked for is left to whoever makes
    it, in a process of its own."""
    summary = Fleet(store).unit(serial)
    if summary is None or summary.last_session is None or summary.is_undated:
        return False
    unit = Units(store).key(serial)
    return Outlooks(store).rests_on(unit) != digest(of_type(store, unit))
