"""Work that nobody asked for although it is missing is asked for: at the start of a service, and now and then."""

from collections.abc import Callable
from datetime import datetime
from threading import Event

from service.groups.store import Groups
from service.jobs.failures_store import Failures
from service.kit.bell import Bell
from service.kit.guard import Alone, Guard, plainly
from service.kit.metrics import Metrics
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.records.refresh_group import current
from service.sessions.store import Sessions
from service.settings import VERSION
from service.storage import Storage
from service.work.kinds import DIAGNOSES

BATCH = 500
"""Sessions that one query brings."""


def ask_for_missing(storage: Storage, clock: Callable[[], datetime], metrics: Metrics, bell: Bell, stop: Event) -> None:
    """At the start: asks for the diagnosis of every session that has none, or on which an older version failed; what
    failed is tried again."""
    last = ""
    with Guard(metrics).alone(DIAGNOSES.name, ""):
        with storage.database.writing() as store:
            Failures(store).try_again()
        while not stop.is_set():
            with storage.database.reading() as store:
                missing = Sessions(store).without_diagnosis(last, BATCH, VERSION)
            if not missing:
                return
            with storage.database.writing() as store:
                WorkQueue(store, WorkKind.DIAGNOSIS).ask_once(missing, clock())
            bell.ring()
            last = missing[-1]


def ask_for_outdated(storage: Storage, clock: Callable[[], datetime], alone: Alone = plainly) -> int:
    """Asks for every group whose answer does not rest on its sessions of now, as after an update; returns how many."""
    with storage.database.reading() as store:
        groups = Groups(store).every()
    count = 0
    for group in groups:
        with alone("groups", group.name):
            with storage.database.reading() as store:
                is_wanted = current(store, group) is None and WorkQueue(store, WorkKind.GROUP).get(group.place) is None
            if is_wanted:
                count += 1
                with storage.database.writing() as store:
                    WorkQueue(store, WorkKind.GROUP).ask_each((group.place,), clock())
    return count
