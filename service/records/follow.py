"""Flow: what follows from a change of records is worked out after the transaction that changed them, with none open.

What that transaction left is kept by the sessions themselves, so whatever ends the process between the two, the work
beside the requests (`service.work.watch`) finds it.
"""

from collections.abc import Sequence

from service.diagnosis.store import Diagnoses
from service.fleet.changes import ask_for_summaries
from service.judging.known_unit import known_unit
from service.judging.records import Counted
from service.judging.store import Derivations
from service.kit.guard import ending_here, kept
from service.outlook.changes import END_OF_TIME
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.records.derive_again import AT_ONCE, Derived, Deriving, sum_up
from service.records.judge_again import fitting, judged, judging, places_of, put
from service.records.refresh_outlooks import date
from service.records.weigh import weighable, weighed_again
from service.sessions.store import NOT_JUDGED
from service.storage import Storage
from service.storage.store import Store
from service.units.store import Units


def follow(storage: Storage, way: Deriving, serial: str, derived: Derived) -> None:
    """After a change of a unit's records: verdicts, their reservations, and dates. What fails is kept with why,
    and costs the change itself nothing."""
    with ending_here("derivations", serial):
        derive_left(storage, way, serial, derived)
    date(storage, way, serial)


def derive_left(storage: Storage, way: Deriving, serial: str, derived: Derived) -> None:
    """What a transaction has left to whoever changed the records; the rest is left to the work beside the requests."""
    if not derived.is_left:
        return

    def keep(why: str) -> None:
        with storage.database.writing() as store:
            WorkQueue(store, WorkKind.DERIVATION).keep_failed(serial, why, way.at)

    with kept(keep):
        if derived.waiting:
            judge_waiting(storage, way, serial, len(derived.judged), derived.judged)
            return
        while derive_waiting_of(storage, way, serial, AT_ONCE):
            pass


def derive_waiting_of(storage: Storage, way: Deriving, serial: str, most: int) -> int:
    """Judges the first of the sessions that wait, or weighs them once all are judged; how many still wait."""
    with storage.database.reading() as store:
        known = known_unit(store, Units(store).key(serial))
    counted = known.records.counted
    if any(one.basis == NOT_JUDGED for one in counted):
        return judge_waiting(storage, way, serial, most)
    return _weigh_waiting(storage, way, serial, [one for one in counted if one.is_unweighed][:most])


def judge_waiting(storage: Storage, way: Deriving, serial: str, most: int, only: tuple[str, ...] | None = None) -> int:
    """Judges the first of the sessions that are to be judged, or the first of some; how many wait for anything."""
    with storage.database.reading() as store:
        known = known_unit(store, Units(store).key(serial))
        waiting = tuple(p for p in places_of(known) if p.session.basis == NOT_JUDGED)
        places = tuple(p for p in waiting if only is None or p.session.id in only)[:most]
        foreseen = judged(known, judging(known, serial, places, way.files, way.coverage_factor, way.at), places)
    with storage.database.writing() as store:
        known = known_unit(store, Units(store).hold(serial))
        waiting = tuple(p for p in places_of(known) if p.session.basis == NOT_JUDGED)
        by = judging(known, serial, waiting, way.files, way.coverage_factor, way.at)
        fit = fitting(by, waiting, foreseen)
        Derivations(store).look_again(known.unit, END_OF_TIME, [p.session.id for p in fit])
        put(known, fit, foreseen, known.records.diagnosed.keys())
        return _left(store, way, serial)


def _weigh_waiting(storage: Storage, way: Deriving, serial: str, sessions: Sequence[Counted]) -> int:
    """Sessions that are judged; those of which something changed meanwhile are left."""
    found = [weighed_again(storage, session) for session in sessions]
    with storage.database.writing() as store:
        known = known_unit(store, Units(store).hold(serial))
        unweighed = {one.id: one for one in known.records.counted if one.is_unweighed}
        for one in found:
            own = unweighed.get(one.id)
            if own is None or weighable(store, own) != one.of:
                continue
            if one.reservations is not None:
                Diagnoses(store).put_reservations(one.id, one.reservations)
            Derivations(store).put_weighed((one.id,))
        return _left(store, way, serial)


def _left(store: Store, way: Deriving, serial: str) -> int:
    """How many sessions of a unit wait; where none does any more, what follows from all of them."""
    left = Derivations(store).waiting_of(serial)
    if not left:
        WorkQueue(store, WorkKind.DERIVATION).drop(serial)
        sum_up(store, way, serial)
        ask_for_summaries(store, serial, way.at)
    return left
