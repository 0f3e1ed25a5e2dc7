"""Flow: the consequences of a change of records, computed after the transaction that changed them, with none open.

The sessions themselves keep the work that the transaction left, so whatever ends the process between the two, the
background work (`service.work.watch`) finds it.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from datetime import datetime
from threading import Lock
from weakref import WeakValueDictionary

from service.diagnosis.store import Diagnoses
from service.fleet.changes import ask_for_summaries
from service.fleet.store import Fleet
from service.judging.records import Counted
from service.judging.reference import known_unit
from service.judging.store import Derivations
from service.kit.guard import ending_here, kept
from service.outlook.changes import END_OF_TIME, gathered, known_of, worked_out
from service.outlook.records import UnitOutlook
from service.outlook.rules.forecast import Past
from service.outlook.rules.histories import type_evidence
from service.outlook.store import Outlooks
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.records.derive_again import AT_ONCE, Derived, Deriving, sum_up
from service.records.flagging.acts import Occasion
from service.records.flagging.drift import flag_drift
from service.records.flagging.fold import settle_sessions
from service.records.flagging.lasting import no_longer_overdue
from service.records.judge_again import fitting, judged, judging, places_of, put
from service.records.weigh import weighable, weighed_again
from service.sessions.store import NOT_JUDGED
from service.storage import Storage
from service.storage.queries import Store
from service.units.store import Units


def follow(storage: Storage, context: Deriving, serial: str, derived: Derived) -> None:
    """After a change of a unit's records: verdicts, their reservations, and dates. What fails is kept with why,
    and costs the change itself nothing."""
    with _alone(storage.database.url, serial):
        with ending_here("derivations", serial):
            derive_left(storage, context, serial, derived)
        date(storage, context, serial)


PATIENCE = 10.0
"""Seconds that one change waits for what follows from another of the same unit; then both are worked out at once."""
_own, _units = Lock(), WeakValueDictionary[tuple[str, str], "_Unit"]()


class _Unit:
    """A unit of which something is worked out."""

    def __init__(self) -> None:
        self.turn = Lock()


@contextmanager
def _alone(url: str, serial: str) -> Iterator[None]:
    """Works out the consequences of many changes of a unit at once, once or twice: whoever comes meanwhile finds them
    done."""
    with _own:
        unit = _units.setdefault((url, serial), _Unit())
    has_turn = unit.turn.acquire(timeout=PATIENCE)
    try:
        yield
    finally:
        if has_turn:
            unit.turn.release()


def derive_left(storage: Storage, context: Deriving, serial: str, derived: Derived) -> None:
    """Judges what a transaction has left to the caller that changed the records; the rest is left to background
    work.
    """
    if not derived.is_left:
        return

    def keep(why: str) -> None:
        with storage.database.writing() as store:
            WorkQueue(store, WorkKind.DERIVATION).add_failed(serial, why, context.at)

    with kept(keep):
        if derived.waiting:
            judge_waiting(storage, context, serial, len(derived.judged), derived.judged)
            return
        while derive_waiting_of(storage, context, serial, AT_ONCE):
            pass


def derive_waiting_of(storage: Storage, context: Deriving, serial: str, most: int) -> int:
    """Judges the first of the sessions that wait, or weighs them once all are judged; how many still wait."""
    with storage.database.reading() as store:
        known = known_unit(store, Units(store).key(serial))
    counted = known.records.counted
    if any(session.basis == NOT_JUDGED for session in counted):
        return judge_waiting(storage, context, serial, most)
    return _weigh_waiting(storage, context, serial, [session for session in counted if session.is_unweighed][:most])


def judge_type(storage: Storage, context: Deriving, name: str) -> None:
    """Judges what waits of the units of a type, before the background work comes to it."""
    with storage.database.reading() as store:
        serials = Units(store).of_type(name)
    for serial in serials:
        with ending_here("derivations", serial):
            while derive_waiting_of(storage, context, serial, AT_ONCE):
                pass
        date(storage, context, serial)


def judge_waiting(
    storage: Storage, context: Deriving, serial: str, most: int, only: tuple[str, ...] | None = None
) -> int:
    """Judges the first of the sessions that are to be judged, or the first of some; how many wait for anything."""
    with storage.database.reading() as store:
        known = known_unit(store, Units(store).key(serial))
        waiting = tuple(p for p in places_of(known) if p.session.basis == NOT_JUDGED)
        places = tuple(p for p in waiting if only is None or p.session.id in only)[:most]
        foreseen = judged(
            known, judging(known, serial, places, context.files, context.coverage_factor, context.at), places
        )
    with storage.database.writing() as store:
        known = known_unit(store, Units(store).hold(serial))
        waiting = tuple(p for p in places_of(known) if p.session.basis == NOT_JUDGED)
        rules = judging(known, serial, waiting, context.files, context.coverage_factor, context.at)
        fit = fitting(rules, waiting, foreseen)
        Derivations(store).look_again(known.unit, END_OF_TIME, [p.session.id for p in fit])
        put(known, fit, foreseen, known.records.diagnosed.keys())
        return _left(store, context, serial)


def _weigh_waiting(storage: Storage, context: Deriving, serial: str, sessions: Sequence[Counted]) -> int:
    """Sessions that are judged; those of which something changed meanwhile are left."""
    found = [weighed_again(storage, session) for session in sessions]
    with storage.database.writing() as store:
        known = known_unit(store, Units(store).hold(serial))
        unweighed = {session.id: session for session in known.records.counted if session.is_unweighed}
        for weighed in found:
            session = unweighed.get(weighed.id)
            if session is None or weighable(store, session) != weighed.weighable:
                continue
            if weighed.reservations is not None:
                Diagnoses(store).put_reservations(weighed.id, weighed.reservations)
            Derivations(store).put_weighed((weighed.id,))
        return _left(store, context, serial)


def _left(store: Store, context: Deriving, serial: str) -> int:
    """The number of a unit's waiting sessions; where there are none any more, all that follows from the sessions is
    made.
    """
    left = Derivations(store).waiting_of(serial)
    if not left:
        WorkQueue(store, WorkKind.DERIVATION).drop(serial)
        sum_up(store, context, serial)
        ask_for_summaries(store, serial, context.at)
    return left


def date(storage: Storage, context: Deriving, *serials: str) -> None:
    """Computes dates after a change of records, where no background process does it. A failure is kept with its reason,
    and does not affect anybody else.
    """
    for serial in () if context.is_dated_later or not context.outlook else serials:
        with ending_here("outlook", serial):
            date_one(storage, serial, context.at)


def date_one(storage: Storage, serial: str, now: datetime) -> None:
    """Makes the outlook of one unit; its failure is the caller's too."""

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
        evidence = type_evidence(known)
        with storage.database.writing() as store:
            Units(store).hold(serial)
            if not WorkQueue(store, WorkKind.OUTLOOK).holds(serial, asked.ticket):
                continue
            Outlooks(store).put_histories(unit, evidence)
        with storage.database.reading() as store:
            sources = gathered(store, serial, known)
        outlook = worked_out(sources)
        with storage.database.writing() as store:
            Units(store).hold(serial)
            if not WorkQueue(store, WorkKind.OUTLOOK).holds(serial, asked.ticket):
                continue
            WorkQueue(store, WorkKind.OUTLOOK).drop(serial)
            put_outlook(store, sources.past, outlook, now)
            return


def put_outlook(store: Store, past: Past, outlook: UnitOutlook, now: datetime) -> None:
    """Keeps a unit's outlook, and settles the flags that rest on it."""
    unit = Units(store).key(past.serial)
    Outlooks(store).put(unit, outlook)
    ask_for_summaries(store, past.serial, now)
    summary = Fleet(store).unit(past.serial)
    session = None if summary is None else summary.last_session
    occasion, made = Occasion(unit, session, now), Outlooks(store).of_unit(past.serial)
    settle_sessions(store, occasion)
    no_longer_overdue(store, occasion, made, past.latest)
    flag_drift(store, occasion, made)
