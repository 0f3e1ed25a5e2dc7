"""Work beside the requests that stands in a queue in the database: claimed by one process at a time, made in a process
of its own, and given up where the program fails at it or no process outlives it."""

from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime, timedelta
from threading import Event
from typing import Generic, Protocol, TypeVar

from service.background.diagnose_waiting import CLAIM, EXTEND, MOST_ATTEMPTS, PUT_OFF, Diagnosing
from service.background.helper import Helper, Still, StoppingError
from service.flows.guard import Failure
from service.log import log
from service.storage import Storage
from service.storage.store import Store

T = TypeVar("T")
"""What stands in a queue."""


class Queue(Protocol[T]):
    """What is asked for."""

    def waiting(self, now: datetime, limit: int) -> tuple[T, ...]:
        """What nobody is at, the first before all."""

    def claim(self, one: T, now: datetime, until: datetime) -> int | None:
        """How often it was begun since a claim ended with a word; None where another is at it."""

    def extend(self, one: T, until: datetime) -> None:
        """Whoever claimed it is still at it."""

    def hold_up(self, one: T, why: str) -> None:
        """Keeps why a try failed."""

    def give_back(self, one: T) -> None:
        """The program failed or its process died: the next one may take it at once."""

    def put_off(self, one: T, until: datetime | None) -> None:
        """Ends a claim with a word of why: nobody begins it before a time."""


@dataclass(frozen=True)
class Work(Generic[T]):
    """One kind of it."""

    name: str
    """As the log and the figures name it."""
    queue: Callable[[Store], Queue[T]]
    make: Callable[[Helper, T, datetime, Still], Failure | None]
    give_up: Callable[[Storage, T, datetime], None]
    """Keeps that the program failed at it, or that no process outlived it."""
    most: int = MOST_ATTEMPTS
    """Tries at which the program may fail, or its process die."""
    put_off: timedelta = PUT_OFF
    """After a try that something passing hindered."""


def work_next(own: Diagnosing, helper: Helper, stop: Event, work: Work[T]) -> bool:
    """Makes what is next; whether there was anything."""
    claimed = _claimed(own, work)
    if claimed is None:
        return False
    one, attempts = claimed
    if attempts > work.most:
        log.error("work beside the requests given up", work=work.name, of=str(one))
        work.give_up(own.storage, one, own.clock())
    else:
        _make(own, helper, stop, work, one)
    own.bell.ring()
    return True


def _claimed(own: Diagnosing, work: Work[T]) -> tuple[T, int] | None:
    now = own.clock()
    with own.storage.database.reading() as store:
        waiting = work.queue(store).waiting(now, 1 + own.settings.diagnosis_workers)
    for one in waiting:
        with own.storage.database.writing() as store:
            attempts = work.queue(store).claim(one, now, now + CLAIM)
        if attempts is not None:
            return one, attempts
    return None


def _make(own: Diagnosing, helper: Helper, stop: Event, work: Work[T], one: T) -> None:
    """Whatever hinders it leaves it asked for."""
    last = own.clock()

    def still() -> bool:
        nonlocal last
        now = own.clock()
        if now - last > EXTEND:
            last = now
            with own.storage.database.writing() as store:
                work.queue(store).extend(one, now + CLAIM)
        return not stop.is_set()

    try:
        failure = work.make(helper, one, last, still)
    except StoppingError:
        with own.storage.database.writing() as store:
            work.queue(store).put_off(one, None)
    else:
        if failure is not None:
            _leave(own, work, one, failure)


def _leave(own: Diagnosing, work: Work[T], one: T, failure: Failure) -> None:
    """What is foreseen passes, and is tried for ever; at what is not, a few times."""
    _note(own, work, one, failure)
    with own.storage.database.writing() as store:
        work.queue(store).hold_up(one, failure.reason)
        if failure.is_foreseen:
            work.queue(store).put_off(one, own.clock() + work.put_off)
        else:
            work.queue(store).give_back(one)


def _note(own: Diagnosing, work: Work[T], one: T, failure: Failure) -> None:
    log.warning(work.name, of=str(one), reason=failure.reason)
    own.metrics.count_fault(work.name, failure.fault)
