"""Flow: a unit's outlook is worked out beside the requests that changed its history, with no transaction open."""

from datetime import datetime

from service.flows.flagging.drift import flag_drift
from service.flows.flagging.settle import Occasion
from service.flows.refresh_outlook import gathered, known_of, worked_out
from service.flows.summarise import ask_for_summaries
from service.judging.histories import told_of_type
from service.storage import Storage


def refresh_beside(storage: Storage, serial: str, now: datetime) -> None:
    """Brings a unit's outlook and the flags that rest on it in line with its history, where somebody asks for it.

    Where its history changes meanwhile it is made anew.
    """
    while True:
        with storage.database.reading() as store:
            ticket = store.pending_outlooks.ticket(serial)
            if ticket is None:
                return
            unit, known = store.units.key(serial), known_of(store, serial)
        told = told_of_type(known)
        with storage.database.writing() as store:
            store.units.hold(serial)
            if not store.pending_outlooks.holds(unit, ticket):
                continue
            store.outlooks.put_histories(unit, told)
        with storage.database.reading() as store:
            sources = gathered(store, serial, known)
        outlook = worked_out(sources)
        with storage.database.writing() as store:
            store.units.hold(serial)
            if not store.pending_outlooks.holds(unit, ticket):
                continue
            store.pending_outlooks.settle(unit)
            store.outlooks.put(unit, outlook)
            ask_for_summaries(store, serial, now)
            summary = store.fleet.unit(serial)
            session = None if summary is None else summary.last_session
            flag_drift(store, Occasion(unit, session, now), store.outlooks.of_unit(serial))
            return
