"""Work beside the requests: claimed in the database by one process of all services on it, made in a process of its own,
and given up where the program fails at it or no process outlives it. Long files are taken in by a thread of their own,
so that diagnoses and other jobs go on meanwhile; each is read by a process of its own, as in a request.

Whoever begins a piece leases it for a short time, and says again and again that he is still at it. Where a process dies
the lease expires and another one begins anew.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from datetime import datetime, timedelta
from threading import Event, Thread

from service.kit.bell import Bell
from service.kit.guard import FORESEEN, Failure, Guard, ending_here
from service.kit.log import log
from service.kit.metrics import Metrics
from service.records.reception import Reception
from service.settings import Settings
from service.storage import Storage
from service.uploads.take_in import take_in
from service.work.helper import Helper, Still, StoppingError
from service.work.kinds import AT_LAST, DIAGNOSES, IN_TURN, LEASE, UPLOADS, Kind

EXTEND = timedelta(seconds=10)
"""Between two words that somebody is still at it."""
LOOK_EVERY = 1.0
"""Seconds between two looks at what other services left; what this one takes in rings."""
RETRY = 60.0
"""Seconds after a look that failed, as when the database is away."""
EXTEND_UPLOAD = 5.0
"""Seconds between two words that somebody is still at an upload."""
Make = Callable[[Kind, str, datetime, Still], Failure | None]
"""Makes one piece, as a process does."""


@dataclass(frozen=True)
class Worker:
    """What work beside the requests takes."""

    settings: Settings
    storage: Storage
    clock: Callable[[], datetime]
    metrics: Metrics
    bell: Bell


def work_beside(own: Worker, stop: Event) -> None:
    """Makes what is asked for until ``stop`` is set."""
    helper = Helper(own.settings)

    def work() -> bool:
        """One piece of each kind that has its turn, else one of the others; whether there was any."""
        helper.start()
        worked = [work_next(own, helper.make, stop, kind) for kind in IN_TURN]
        return any(worked) or any(work_next(own, helper.make, stop, kind) for kind in AT_LAST)

    try:
        _work_until(own, stop, DIAGNOSES.name, work)
    finally:
        helper.end()


def take_in_waiting(own: Worker, stop: Event) -> None:
    """Takes in the long files that wait until ``stop`` is set."""
    make = taking_in(own)
    _work_until(own, stop, UPLOADS.name, lambda: work_next(own, make, stop, UPLOADS))


def _work_until(own: Worker, stop: Event, name: str, work: Callable[[], bool]) -> None:
    while not stop.is_set():
        rung, guard = own.bell.rung, Guard(own.metrics)
        with guard.alone(name, ""):
            while not stop.is_set() and work():
                rung = own.bell.rung
        own.bell.wait(rung, RETRY if guard.failed else LOOK_EVERY)


def work_next(own: Worker, make: Make, stop: Event, kind: Kind) -> bool:
    """Makes what is next of a kind; whether there was anything."""
    claimed = _claimed(own, kind)
    if claimed is None:
        return False
    one, attempts = claimed
    if attempts > kind.most:
        log.error("work beside the requests given up", work=kind.name, of=one)
        kind.end(own.storage, one, own.clock())
    else:
        _make(own, make, stop, kind, one)
    own.bell.ring()
    return True


def _claimed(own: Worker, kind: Kind) -> tuple[str, int] | None:
    """What somebody waits for, and else what was asked for first; with how often it was begun."""
    now, urgent = own.clock(), own.bell.urgent() if kind.is_awaited else None
    with own.storage.database.reading() as store:
        waiting = kind.queue(store).waiting(now, 1 + own.settings.diagnosis_workers)
    for one in (*(() if urgent is None else (urgent,)), *waiting):
        with own.storage.database.writing() as store:
            attempts = kind.queue(store).claim(one, now, now + LEASE)
        if attempts is not None:
            return one, attempts
    return None


def _make(own: Worker, make: Make, stop: Event, kind: Kind, one: str) -> None:
    """Whatever hinders it leaves it asked for."""
    last = own.clock()

    def still() -> bool:
        nonlocal last
        now = own.clock()
        if now - last > EXTEND:
            last = now
            with own.storage.database.writing() as store:
                kind.queue(store).extend(one, now + LEASE)
        return not stop.is_set()

    try:
        failure = make(kind, one, last, still)
    except StoppingError:
        with own.storage.database.writing() as store:
            kind.queue(store).put_off(one, None)
    else:
        if failure is not None:
            _leave(own, kind, one, failure)


def _leave(own: Worker, kind: Kind, one: str, failure: Failure) -> None:
    """What is foreseen passes, and is tried for ever; at what is not, a few times."""
    log.warning(kind.name, of=one, reason=failure.reason)
    own.metrics.count_fault(kind.name, failure.fault)
    with own.storage.database.writing() as store:
        queue = kind.queue(store)
        queue.hold_up(one, failure.reason)
        if failure.is_foreseen:
            queue.put_off(one, own.clock() + kind.put_off)
        else:
            queue.give_back(one, own.clock())


def taking_in(own: Worker) -> Make:
    """What takes one in."""
    k = own.settings.coverage_factor
    reception = Reception(own.storage, k, own.metrics, own.bell.ring, is_dated_later=True)
    return lambda _, id, now, still: _taken_in(lambda tick: take_in(reception, int(id), now, tick), id, still)


def _taken_in(work: Callable[[Callable[[], None]], None], id: str, still: Still) -> Failure | None:
    stopping = False

    def tick() -> None:
        nonlocal stopping
        if not still():
            stopping = True
            raise StoppingError(f"Upload {id} was interrupted.")

    with ending_here(UPLOADS.name, id) as met, _said_now_and_then(still):
        work(tick)
    if stopping:
        raise StoppingError(f"Upload {id} was interrupted.")
    return met.failure


@contextmanager
def _said_now_and_then(still: Still) -> Iterator[None]:
    """Keeps the claim also while a file is read in one piece."""
    done = Event()

    def say() -> None:
        while not done.wait(EXTEND_UPLOAD):
            with suppress(*FORESEEN):
                still()

    teller = Thread(target=say, name="claim of an upload", daemon=True)
    teller.start()
    try:
        yield
    finally:
        done.set()
        teller.join()
