"""Units computed again under the models in force, here or by many processes: a unit in one transaction, and one whose
computing fails is told and stops no other.

What is done is not done again: `units_behind` names the units with sessions of an earlier revision than concerns them.
So a run that was ended goes on where it was, and a second one beside it does nothing twice.
"""

from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager
from dataclasses import dataclass
from datetime import datetime
from importlib import import_module
from importlib.util import find_spec

from service.errors import ServiceError
from service.flows.guard import Failure, ending_here
from service.flows.recalibrate import Recalibrated, recalibrate
from service.settings import Settings
from service.storage import Storage

PAGE = 1000
"""Serial numbers that one query brings."""
ROOM = "service.background.workers"
WITHOUT = "Computing in several processes needs a library that is missing: {fault}. Run pip install 'imu-health[dask]'."


@dataclass(frozen=True)
class Outcome:
    """What became of a unit: one of the two is there."""

    unit: str
    done: Recalibrated | None
    failure: Failure | None


Run = Callable[[Iterable[str]], Iterator[Outcome]]
"""Computes units again, by serial number, and tells of each when it is done."""


def units_behind(storage: Storage) -> Iterator[str]:
    """Serial numbers of units with something to compute, as they are when they are asked for."""
    last = ""
    while True:
        with storage.database.reading() as store:
            page = store.models.units_behind(last, PAGE)
        yield from page
        if len(page) < PAGE:
            return
        last = page[-1]


def recalibrate_one(storage: Storage, serial: str, now: datetime, coverage_factor: float) -> Outcome:
    """A unit's sessions; whatever fails is told."""
    done = None
    with ending_here("recalibration", serial) as met:
        done = recalibrate(storage, serial, now, coverage_factor=coverage_factor)
    return Outcome(serial, done, met.failure)


def one_by_one(storage: Storage, clock: Callable[[], datetime], coverage_factor: float) -> Run:
    """In this process."""
    return lambda serials: (recalibrate_one(storage, serial, clock(), coverage_factor) for serial in serials)


def can_share() -> bool:
    """Whether several processes can compute: the library for it is installed."""
    return find_spec("distributed") is not None


def by_workers(
    storage: Storage, settings: Settings, clock: Callable[[], datetime], *, workers: int, scheduler: str | None = None
) -> AbstractContextManager[Run]:
    """By so many processes of this machine, or by those of a Dask scheduler; ServiceError where Dask is missing."""
    try:
        room = import_module(ROOM)
    except ModuleNotFoundError as fault:
        raise ServiceError(WITHOUT.format(fault=fault)) from fault
    with storage.database.reading() as store:
        last = store.audit.last()
    own = room.real_cluster(scheduler) if scheduler else room.local_cluster(settings, workers)
    running: AbstractContextManager[Run] = room.running(own, last, clock)
    return running
