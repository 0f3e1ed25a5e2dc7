"""Background work: claimed in the database by one process of all services on it, done in a separate process, and given
up where the program fails or its process dies every time. Long files are processed by another thread, so that diagnoses
and other jobs go on; each is read in a separate process, as in a request.

A claim is a short lease, which is extended during the work. Where a process dies the lease expires and another one
starts again.
"""

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from datetime import datetime, timedelta
from threading import Event, Thread

from service.kit.bell import Bell
from service.kit.filling import Filling
from service.kit.guard import FORESEEN, Failure, Guard, ending_here
from service.kit.log import log
from service.kit.metrics import Metrics
from service.queue.records import Rank
from service.queue.store import PendingWork
from service.records.reception import Reception
from service.settings import Settings
from service.storage import Storage
from service.uploads.take_in import take_in
from service.work.helper import Helper, KeepGoing, StoppingError
from service.work.kinds import DIAGNOSES, KINDS, LEASE, SUMMARIES, UPLOADS, Kind

LEASE_EXTENSION = timedelta(seconds=10)
"""Time between two extensions of a lease."""
POLL_SECONDS = 1.0
"""Seconds between two checks for work requested by other services; for work of this one the bell rings."""
RETRY_SECONDS = 60.0
"""Seconds after a check that failed, as when the database is unavailable."""
EXTENSION_SECONDS = 5.0
"""Seconds between two extensions of the lease of what a thread of the service does."""
Make = Callable[[Kind, str, datetime, KeepGoing], Failure | None]
"""Does one piece of work in a process."""


@dataclass(frozen=True)
class Worker:
    """Environment of background work."""

    settings: Settings
    storage: Storage
    clock: Callable[[], datetime]
    metrics: Metrics
    bell: Bell
    filling: Filling | None = None
    """Demonstration that is being stored: until its end nothing else is done about it, so that it is always the same.
    """

    @property
    def last_rank(self) -> Rank:
        """The last rank of the work that is done now."""
        return Rank.FOLLOWING if self.filling is not None and not self.filling.is_over else max(Rank)


def work_in_background(worker: Worker, stop: Event) -> None:
    """Does requested work until ``stop`` is set."""
    helper = Helper(worker.settings)

    def work() -> bool:
        """The next piece; whether there was any."""
        helper.start()
        return work_next(worker, helper.make, stop, *KINDS.values())

    try:
        _work_until(worker, stop, DIAGNOSES.name, work)
    finally:
        helper.end()


def summarise_waiting(worker: Worker, stop: Event) -> None:
    """Makes waiting summaries of the fleet until ``stop`` is set, where no process does: they take minutes in a large
    fleet, and no page waits for them."""

    def make(kind: Kind, place: str, now: datetime, keep_going: KeepGoing) -> Failure | None:
        assert kind.make is not None
        with ending_here(kind.kind.value, place) as outcome, _lease_extended(keep_going):
            kind.make(worker.storage, place, now, worker.settings.coverage_factor)
        return outcome.failure

    _work_until(worker, stop, SUMMARIES.name, lambda: work_next(worker, make, stop, SUMMARIES))


def take_in_waiting(worker: Worker, stop: Event) -> None:
    """Processes waiting long files until ``stop`` is set."""
    make = upload_maker(worker)
    _work_until(worker, stop, UPLOADS.name, lambda: work_next(worker, make, stop, UPLOADS))


def _work_until(worker: Worker, stop: Event, name: str, work: Callable[[], bool]) -> None:
    while not stop.is_set():
        rung, guard = worker.bell.rung, Guard(worker.metrics)
        with guard.alone(name, ""):
            while not stop.is_set() and work():
                rung = worker.bell.rung
        worker.bell.wait(rung, RETRY_SECONDS if guard.failed else POLL_SECONDS)


def work_next(worker: Worker, make: Make, stop: Event, *kinds: Kind) -> bool:
    """Does the next piece of some kinds; whether there was any."""
    claimed = _claimed(worker, kinds)
    if claimed is None:
        return False
    kind, key, attempts = claimed
    if attempts > kind.most:
        log.error("work beside the requests given up", work=kind.name, of=key)
        kind.end(worker.storage, key, worker.clock())
    else:
        _make(worker, make, stop, kind, key)
    worker.bell.ring()
    return True


def _claimed(worker: Worker, kinds: Iterable[Kind]) -> tuple[Kind, str, int] | None:
    """The first piece in order, with the number of its leases."""
    now, by_name = worker.clock(), {kind.kind: kind for kind in kinds}
    with worker.storage.database.reading() as store:
        waiting = PendingWork(store).first(by_name, now, 1 + worker.settings.diagnosis_workers, worker.last_rank)
    for name, key in waiting:
        with worker.storage.database.writing() as store:
            attempts = by_name[name].queue(store).claim(key, now, now + LEASE)
        if attempts is not None:
            return by_name[name], key, attempts
    return None


def _make(worker: Worker, make: Make, stop: Event, kind: Kind, key: str) -> None:
    """Does a piece; it stays requested where it fails."""
    last = worker.clock()

    def keep_going() -> bool:
        nonlocal last
        now = worker.clock()
        if now - last > LEASE_EXTENSION:
            last = now
            with worker.storage.database.writing() as store:
                kind.queue(store).extend(key, now + LEASE)
        return not stop.is_set()

    try:
        failure = make(kind, key, last, keep_going)
    except StoppingError:
        with worker.storage.database.writing() as store:
            kind.queue(store).put_off(key, None)
    else:
        if failure is not None:
            _after_failure(worker, kind, key, failure)


def _after_failure(worker: Worker, kind: Kind, key: str, failure: Failure) -> None:
    """A foreseen failure passes, and the work is attempted without limit; after any other a few times."""
    log.warning(kind.name, of=key, reason=failure.reason)
    worker.metrics.count_fault(kind.name, failure.fault)
    with worker.storage.database.writing() as store:
        queue = kind.queue(store)
        queue.record_failure(key, failure.reason)
        if failure.is_foreseen:
            queue.put_off(key, worker.clock() + kind.put_off)
        else:
            queue.give_back(key, worker.clock())


def upload_maker(worker: Worker) -> Make:
    """Function that processes an upload."""
    k = worker.settings.coverage_factor
    reception = Reception(worker.storage, k, worker.metrics, worker.bell.ring, is_dated_later=True)
    return lambda _, id, now, keep_going: _taken_in(lambda tick: take_in(reception, int(id), now, tick), id, keep_going)


def _taken_in(work: Callable[[Callable[[], None]], None], id: str, keep_going: KeepGoing) -> Failure | None:
    stopping = False

    def tick() -> None:
        nonlocal stopping
        if not keep_going():
            stopping = True
            raise StoppingError(f"Upload {id} was interrupted.")

    with ending_here(UPLOADS.name, id) as outcome, _lease_extended(keep_going):
        work(tick)
    if stopping:
        raise StoppingError(f"Upload {id} was interrupted.")
    return outcome.failure


@contextmanager
def _lease_extended(keep_going: KeepGoing) -> Iterator[None]:
    done = Event()

    def extend() -> None:
        while not done.wait(EXTENSION_SECONDS):
            with suppress(*FORESEEN):
                keep_going()

    thread = Thread(target=extend, name="lease", daemon=True)
    thread.start()
    try:
        yield
    finally:
        done.set()
        thread.join()
