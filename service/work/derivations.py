"""Sessions that a change of records or of a model left to be derived again."""

from collections.abc import Callable
from datetime import datetime
from threading import Event

from service.judging.store import Derivations
from service.kit.guard import Alone, Guard, kept, plainly
from service.kit.metrics import Metrics
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.records.derive_again import Deriving
from service.records.follow import derive_waiting_of
from service.records.refresh_outlooks import date
from service.storage import Storage

LOOK_EVERY = 2.0
"""Seconds between two looks: a person who changed a record waits for it."""
RETRY = 60.0
"""Seconds after a look in which something failed: what fails for good is told once a minute."""
BATCH = 10
"""Sessions that are worked out before they are put down together."""


def derive_pending(
    storage: Storage, coverage_factor: float, clock: Callable[[], datetime], metrics: Metrics, stop: Event
) -> None:
    """Judges what waits until ``stop`` is set; what a crash interrupts still waits at the next start, and a unit on
    which something fails waits for the next look."""
    pause = LOOK_EVERY
    while not stop.wait(pause):
        guard = Guard(metrics)
        with guard.alone("derivations", ""):
            derive_waiting(storage, coverage_factor, clock, stop, guard.alone)
        pause = RETRY if guard.failed else LOOK_EVERY


def derive_waiting(
    storage: Storage, coverage_factor: float, clock: Callable[[], datetime], stop: Event, alone: Alone = plainly
) -> None:
    """Judges everything that waits now, unit after unit."""
    with storage.database.reading() as store:
        serials = Derivations(store).waiting()
    for serial in serials:
        with alone("derivations", serial), kept(_failed_at(storage, serial, clock)):
            _derive_unit(storage, coverage_factor, clock, stop, serial)


def _failed_at(storage: Storage, serial: str, clock: Callable[[], datetime]) -> Callable[[str], None]:
    def keep(why: str) -> None:
        with storage.database.writing() as store:
            WorkQueue(store, WorkKind.DERIVATION).keep_failed(serial, why, clock())

    return keep


def _derive_unit(
    storage: Storage, coverage_factor: float, clock: Callable[[], datetime], stop: Event, serial: str
) -> None:
    left = 1
    while left and not stop.is_set():
        way = Deriving(storage.files, coverage_factor, clock())
        left = derive_waiting_of(storage, way, serial, BATCH)
    date(storage, way, serial)
