"""Flow: outlooks are made again where the other units of their type have told more since."""

from datetime import datetime

from service.flows.flagging.drift import flag_drift
from service.flows.flagging.settle import Occasion
from service.flows.refresh_outlook import digest, of_type, refresh_outlook
from service.storage import Storage
from service.storage.store import Store


def relearn(storage: Storage, now: datetime) -> int:
    """Brings every outlook up to what its type tells by now, and returns how many that were.

    What a unit tells of its type does not depend on the type, so one round is enough, and the outlooks of a fleet do
    not depend on the order in which its sessions came.
    """
    with storage.database.reading() as store:
        stale = [serial for serial in store.units.every() if _is_stale(store, serial)]
    for serial in stale:
        with storage.database.writing() as store:
            unit = store.units.hold(serial)
            refresh_outlook(store, serial)
            summary = store.fleet.unit(serial)
            session = None if summary is None else summary.last_session
            flag_drift(store, Occasion(unit, session, now), store.outlooks.of_unit(serial))
    return len(stale)


def _is_stale(store: Store, serial: str) -> bool:
    unit = store.units.key(serial)
    return store.outlooks.rests_on(unit) not in ("", digest(of_type(store, unit)))
