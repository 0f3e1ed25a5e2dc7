"""Work beside the requests: long files that were received whole, one after another, in a thread of their own. The file
is read by a process of its own as in a request, so that diagnoses and other jobs go on meanwhile.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from datetime import datetime, timedelta
from threading import Event, Thread

from service.jobs.words import FILE_AT_FAULT
from service.kit.guard import FORESEEN, Failure, Guard, ending_here
from service.queue.records import WorkKind
from service.records.reception import Reception
from service.storage import Storage
from service.uploads.take_in import give_up, take_in
from service.work.helper import Still, StoppingError
from service.work.kinds import Kind
from service.work.loop import Make, Worker, work_next

LOOK_EVERY = 2.0
"""Seconds between two looks at what other services left; what this one takes in rings."""
RETRY = 60.0
"""Seconds after a look that failed, as when the database is away."""
PUT_OFF = timedelta(minutes=1)
"""After a try that something passing hindered: somebody waits for the verdict."""
MOST_TRIES = 10
"""At which the program may fail, or its service be ended: a file that is read for minutes outlives some restarts, and
what was acknowledged is not given up for them."""
WORD_EVERY = 5.0
"""Seconds between two words that somebody is still at it."""
WORK = "uploads"
"""As the log and the figures name it."""


def take_in_waiting(own: Worker, stop: Event) -> None:
    """Takes in what waits until ``stop`` is set."""
    make = taking_in(own)
    while not stop.is_set():
        rung, guard = own.bell.rung, Guard(own.metrics)
        with guard.alone(WORK, ""):
            while not stop.is_set() and work_next(own, make, stop, UPLOADS):
                rung = own.bell.rung
        own.bell.wait(rung, RETRY if guard.failed else LOOK_EVERY)


def taking_in(own: Worker) -> Make:
    """What takes one in."""
    k = own.settings.coverage_factor
    reception = Reception(own.storage, k, own.metrics, own.bell.ring, is_dated_later=True)
    return lambda _, id, now, still: _taken_in(lambda tick: take_in(reception, int(id), now, tick), id, still)


def _give_up(storage: Storage, id: str, now: datetime) -> None:
    give_up(storage, int(id), FILE_AT_FAULT, now)


UPLOADS = Kind(WORK, WorkKind.UPLOAD, None, _give_up, most=MOST_TRIES, put_off=PUT_OFF)


def _taken_in(work: Callable[[Callable[[], None]], None], id: str, still: Still) -> Failure | None:
    stopping = False

    def tick() -> None:
        nonlocal stopping
        if not still():
            stopping = True
            raise StoppingError(f"Upload {id} was interrupted.")

    with ending_here(WORK, id) as met, _said_now_and_then(still):
        work(tick)
    if stopping:
        raise StoppingError(f"Upload {id} was interrupted.")
    return met.failure


@contextmanager
def _said_now_and_then(still: Still) -> Iterator[None]:
    """Keeps the claim also while a file is read in one piece."""
    done = Event()

    def say() -> None:
        while not done.wait(WORD_EVERY):
            with suppress(*FORESEEN):
                still()

    teller = Thread(target=say, name="claim of an upload", daemon=True)
    teller.start()
    try:
        yield
    finally:
        done.set()
        teller.join()
