"""Work beside the requests: claimed in the database by one process of all services on it, made in a process of its own,
and given up where the program fails at it or no process outlives it.

Whoever begins a piece leases it for a short time, and says again and again that he is still at it. Where a process dies
the lease expires and another one begins anew.
"""

from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime, timedelta
from threading import Event

from service.kit.bell import Bell
from service.kit.guard import Failure
from service.kit.log import log
from service.kit.metrics import Metrics
from service.settings import Settings
from service.storage import Storage
from service.work.helper import Still, StoppingError
from service.work.kinds import LEASE, Kind

EXTEND = timedelta(seconds=10)
"""Between two words that somebody is still at it."""
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
