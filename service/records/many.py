"""Many units computed again, here or by the processes of a Dask cluster.

A unit whose computing fails is reported and stops no other.

Finished units are not computed again: `units_behind` names the units with sessions of an earlier revision than concerns
them. So a run that was ended goes on where it was, and a second one beside it does nothing twice.

A task is a unit: its worker reads, computes, judges and writes, over a connection of its own. Of the work on a session
less than a third is its calibration, and the rest would wait for one writer (`python -m benchmarks.p8_recompute`). A
worker that dies leaves a transaction that the database undoes, and Dask gives the unit to another.

No address and no password travels: a worker reads its own settings, and a task names the last line of the audit trail,
so that a worker with another database refuses it. Processes of this machine speak over TLS with keys made for the run.
"""

import logging
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import CancelledError
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from datetime import datetime
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from itertools import islice

import dask
from distributed import Client, Future, LocalCluster, as_completed

from service.errors import ConflictError, ServiceError
from service.kit import limits
from service.kit.guard import Failure, ending_here
from service.models.store import Models
from service.opening import open_storage
from service.records.recalibrate import Recalibrated, recalibrate
from service.settings import Settings
from service.storage import Storage
from service.storage.audit import Audit

PAGE = 1000
"""Serial numbers that one query brings."""
ROOM = "service.records.many"
WITHOUT = "Computing in several processes needs a library that is missing: {fault}. Run pip install 'imu-health[dask]'."


@dataclass(frozen=True)
class UnitOutcome:
    """Result for a unit: one of the two is given."""

    unit: str
    done: Recalibrated | None
    failure: Failure | None


Run = Callable[[Iterable[str]], Iterator[UnitOutcome]]
"""Computes units again, by serial number, and reports each when it is done."""


def units_behind(storage: Storage) -> Iterator[str]:
    """Serial numbers of units with something to compute, as they are when they are asked for."""
    last = ""
    while True:
        with storage.database.reading() as store:
            page = Models(store).units_behind(last, PAGE)
        yield from page
        if len(page) < PAGE:
            return
        last = page[-1]


def recalibrate_one(storage: Storage, serial: str, now: datetime, coverage_factor: float) -> UnitOutcome:
    """A unit's sessions; whatever fails is reported."""
    done = None
    with ending_here("recalibration", serial) as met:
        done = recalibrate(storage, serial, now, coverage_factor=coverage_factor)
    return UnitOutcome(serial, done, met.failure)


def one_by_one(storage: Storage, clock: Callable[[], datetime], coverage_factor: float) -> Run:
    """Runs one unit after another in this process."""
    return lambda serials: (recalibrate_one(storage, serial, clock(), coverage_factor) for serial in serials)


def can_share() -> bool:
    """Whether several processes can compute: the library for it is installed."""
    return find_spec("distributed") is not None


def by_workers(
    storage: Storage, settings: Settings, clock: Callable[[], datetime], *, workers: int, scheduler: str | None = None
) -> AbstractContextManager[Run]:
    """Runs in so many processes of this machine, or in those of a Dask scheduler; ServiceError where Dask is
    missing.
    """
    try:
        room = import_module(ROOM)
    except ModuleNotFoundError as fault:
        raise ServiceError(WITHOUT.format(fault=fault)) from fault
    with storage.database.reading() as store:
        last = Audit(store).last()
    cluster = room.real_cluster(scheduler) if scheduler else room.local_cluster(settings, workers)
    running: AbstractContextManager[Run] = room.running(cluster, last, clock)
    return running


AHEAD = 4
"""Units that are given to each thread of a worker before it asks: it never waits, and no list of a million is held."""
PATIENCE = "30s"
"""Time to wait for a scheduler, and for its first worker."""
QUIET = {"dashboard": False, "dashboard_address": "127.0.0.1:0"}
"""Dask's own pages need packages that are not installed; its figures are on a port of this machine."""
PROFILING = "distributed.worker.profile.enabled"
"""Dask's setting that samples the work of its workers every hundredth of a second and keeps it for an hour: most of a
gigabyte each.
"""
OTHER = "This worker's database is another one; set its IMU_HEALTH_DATABASE_URL and IMU_HEALTH_DATA_FOLDER."


@contextmanager
def local_cluster(settings: Settings, workers: int) -> Iterator[Client]:
    """Cluster of so many processes of this machine with these settings."""
    environment = {
        "IMU_HEALTH_DATABASE_URL": settings.database,
        "IMU_HEALTH_DATA_FOLDER": str(settings.data_folder),
        "OPENBLAS_NUM_THREADS": "1",
    }
    with (
        dask.config.set({PROFILING: False}),
        LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            security=True,
            scheduler_kwargs=QUIET,
            silence_logs=logging.CRITICAL,
            env=environment,
        ) as cluster,
        Client(cluster) as client,
    ):
        yield client


@contextmanager
def real_cluster(address: str) -> Iterator[Client]:
    """The workers of a scheduler that runs somewhere."""
    try:
        with Client(address, timeout=PATIENCE) as client:
            client.wait_for_workers(1, timeout=PATIENCE)
            yield client
    except (OSError, ValueError, TimeoutError) as fault:
        raise ServiceError(f"The scheduler {address} cannot be used: {fault}") from fault


@contextmanager
def running(cluster: AbstractContextManager[Client], last: str, clock: Callable[[], datetime]) -> Iterator[Run]:
    """Computes units as long as the cluster is there."""
    with cluster as client:
        yield lambda serials: _run(client, serials, last, clock)


def _run(client: Client, serials: Iterable[str], last: str, clock: Callable[[], datetime]) -> Iterator[UnitOutcome]:
    waiting, names, begun = iter(serials), dict[object, str](), as_completed(loop=client.loop)

    def begin(most: int) -> None:
        for serial in islice(waiting, most):
            future = client.submit(_work, last, serial, clock(), pure=False)
            names[future.key] = serial
            begun.add(future)

    begin(AHEAD * sum(client.nthreads().values()))
    for future in begun:
        yield _outcome(future, names.pop(future.key))
        begin(1)


def _outcome(future: Future[UnitOutcome], serial: str) -> UnitOutcome:
    """A unit at which worker after worker died is reported like one that failed."""
    if future.status == "finished":
        return future.result()
    fault = future.exception() if future.status == "error" else CancelledError("it was called off")
    return UnitOutcome(serial, None, Failure(type(fault).__name__, str(fault), is_foreseen=False))


def _work(last: str, serial: str, now: datetime) -> UnitOutcome:
    storage, coverage_factor = _own(last)
    return recalibrate_one(storage, serial, now, coverage_factor)


@cache
def _own(last: str) -> tuple[Storage, float]:
    """Storage and coverage factor by this process's settings, once they are seen to name the database with this
    line.
    """
    settings = Settings()
    limits.use(limits.limits_of(settings))
    storage = open_storage(settings)
    storage.database.require_ready()
    with storage.database.reading() as store:
        if not Audit(store).has(last):
            raise ConflictError(OTHER)
    return storage, settings.coverage_factor
