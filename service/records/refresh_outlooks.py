"""Flow: a unit's outlook is worked out after the transaction that changed its history, with none open."""

from datetime import datetime

from service.fleet.changes import ask_for_summaries
from service.fleet.store import Fleet
from service.kit.guard import ending_here, kept
from service.outlook.changes import gathered, known_of, worked_out
from service.outlook.rules.histories import told_of_type
from service.outlook.store import Outlooks
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.records.derive_again import Deriving
from service.records.flagging.drift import flag_drift
from service.records.flagging.overdue import no_longer_overdue
from service.records.flagging.settle import Occasion
from service.storage import Storage
from service.units.store import Units


def date(storage: Storage, way: Deriving, *serials: str) -> None:
    """After a change of records, where no process beside the requests does it. What fails is kept with why, and costs
    nobody else anything."""
    for serial in () if way.is_dated_later or not way.outlook else serials:
        with ending_here("outlook", serial):
            date_one(storage, serial, way.at)


def date_one(storage: Storage, serial: str, now: datetime) -> None:
    """The same for one unit, whose failure is the caller's too."""

    def keep(why: str) -> None:
        with storage.database.writing() as store:
            WorkQueue(store, WorkKind.OUTLOOK).give_up(serial, why)

    with kept(keep):
        refresh_beside(storage, serial, now)


def refresh_beside(storage: Storage, serial: str, now: datetime) -> None:
    """Brings a unit's outlook and the flags that rest on it in line with its history, where somebody asks for it.

    Where its history changes meanwhile it is made anew.
    """
    while True:
        with storage.database.reading() as store:
            asked = WorkQueue(store, WorkKind.OUTLOOK).get(serial)
            if asked is None:
                return
            unit, known = Units(store).key(serial), known_of(store, serial)
        told = told_of_type(known)
        with storage.database.writing() as store:
            Units(store).hold(serial)
            if not WorkQueue(store, WorkKind.OUTLOOK).holds(serial, asked.ticket):
                continue
            Outlooks(store).put_histories(unit, told)
        with storage.database.reading() as store:
            sources = gathered(store, serial, known)
        outlook = worked_out(sources)
        with storage.database.writing() as store:
            Units(store).hold(serial)
            if not WorkQueue(store, WorkKind.OUTLOOK).holds(serial, asked.ticket):
                continue
            WorkQueue(store, WorkKind.OUTLOOK).drop(serial)
            Outlooks(store).put(unit, outlook)
            ask_for_summaries(store, serial, now)
            summary = Fleet(store).unit(serial)
            session = None if summary is None else summary.last_session
            occasion, made = Occasion(unit, session, now), Outlooks(store).of_unit(serial)
            flag_drift(store, occasion, made)
            no_longer_overdue(store, occasion, made, sources.past.latest)
            return
