"""Flow: a unit's outlook is worked out after the transaction that changed its history, with none open."""

from datetime import datetime

from service.flows.derive_again import Deriving
from service.flows.flagging.drift import flag_drift
from service.flows.flagging.overdue import no_longer_overdue
from service.flows.flagging.settle import Occasion
from service.flows.guard import ending_here, kept
from service.flows.refresh_outlook import gathered, known_of, worked_out
from service.flows.summarise import ask_for_summaries
from service.judging.histories import told_of_type
from service.records.work import WorkKind
from service.storage import Storage


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
            store.work(WorkKind.OUTLOOK).give_up(serial, why)

    with kept(keep):
        refresh_beside(storage, serial, now)


def refresh_beside(storage: Storage, serial: str, now: datetime) -> None:
    """Brings a unit's outlook and the flags that rest on it in line with its history, where somebody asks for it.

    Where its history changes meanwhile it is made anew.
    """
    while True:
        with storage.database.reading() as store:
            asked = store.work(WorkKind.OUTLOOK).get(serial)
            if asked is None:
                return
            unit, known = store.units.key(serial), known_of(store, serial)
        told = told_of_type(known)
        with storage.database.writing() as store:
            store.units.hold(serial)
            if not store.work(WorkKind.OUTLOOK).holds(serial, asked.ticket):
                continue
            store.outlooks.put_histories(unit, told)
        with storage.database.reading() as store:
            sources = gathered(store, serial, known)
        outlook = worked_out(sources)
        with storage.database.writing() as store:
            store.units.hold(serial)
            if not store.work(WorkKind.OUTLOOK).holds(serial, asked.ticket):
                continue
            store.work(WorkKind.OUTLOOK).drop(serial)
            store.outlooks.put(unit, outlook)
            ask_for_summaries(store, serial, now)
            summary = store.fleet.unit(serial)
            session = None if summary is None else summary.last_session
            occasion, made = Occasion(unit, session, now), store.outlooks.of_unit(serial)
            flag_drift(store, occasion, made)
            no_longer_overdue(store, occasion, made, sources.past.latest)
            return
