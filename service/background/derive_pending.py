"""Work beside the requests: sessions that a change of records left to be judged again, some at a time."""

from collections.abc import Callable
from datetime import datetime
from threading import Event

from service.errors import ServiceError
from service.flows.derive_again import Deriving, derive_batch
from service.log import log
from service.storage import Storage

LOOK_EVERY = 2.0
"""Seconds between two looks: a person who changed a record waits for it."""
BATCH = 10
"""Sessions of one transaction, some tenths of a second: an upload of the same unit waits no longer."""


def derive_pending(storage: Storage, coverage_factor: float, clock: Callable[[], datetime], stop: Event) -> None:
    """Judges what waits until ``stop`` is set; what a crash interrupts still waits at the next start."""
    while not stop.wait(LOOK_EVERY):
        try:
            derive_waiting(storage, coverage_factor, clock, stop)
        except ServiceError as fault:
            log.warning("sessions wait to be judged again", reason=str(fault))


def derive_waiting(storage: Storage, coverage_factor: float, clock: Callable[[], datetime], stop: Event) -> None:
    """Judges everything that waits now, unit after unit."""
    with storage.database.reading() as store:
        serials = store.derivations.waiting()
    for serial in serials:
        left = 1
        while left and not stop.is_set():
            way = Deriving(storage.files, coverage_factor, clock())
            with storage.database.writing() as store:
                left = derive_batch(store, way, serial, BATCH)
