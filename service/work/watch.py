"""Background work without a queue: the fleet is checked periodically, missing work is requested, and verdicts are
derived again after a change of records or of a model."""

from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime
from threading import Event

from service.fleet.store import Fleet
from service.groups.store import Groups
from service.jobs.changes import drop_expired
from service.jobs.store import Failures
from service.judging.store import Derivations
from service.judging.usable_reading import settle_all
from service.kit.bell import Bell
from service.kit.guard import Alone, Guard, kept, plainly
from service.kit.metrics import Metrics
from service.outlook.changes import digest, of_type
from service.outlook.store import Outlooks
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.records.derive_again import Deriving
from service.records.flagging.overdue_units import flag_overdue
from service.records.flagging.stands import flag_shifted_stands
from service.records.follow import date, date_one, derive_waiting_of
from service.records.refresh_group import current
from service.sessions.store import Sessions
from service.settings import VERSION
from service.storage import Storage
from service.storage.aside import drop_stale
from service.storage.queries import Store
from service.units.store import Units
from service.uploads.take_in import sweep_waiting
from service.work.kinds import DIAGNOSES


@dataclass(frozen=True)
class Pace:
    """Intervals of the checks, s."""

    first: float = 20.0
    """Delay after the start, which has other work, s."""
    every: float = 3600.0
    """Time between two checks, s: dates fall due by the day."""
    retry: float = 60.0
    """Delay after a check in which something failed, s; doubled after each further one, up to `every`. A database that
    restarts is back within a minute, and a permanent failure is not reported more often than a check.
    """

    def after(self, failures: int) -> float:
        """The pause after a number of failed checks in a row."""
        return self.every if not failures else min(self.every, self.retry * 2 ** min(failures - 1, 20))


def watch_fleet(
    storage: Storage, clock: Callable[[], datetime], metrics: Metrics, stop: Event, pace: Pace | None = None
) -> None:
    """Checks every outlook, due date and stand periodically until ``stop`` is set."""
    pace = pace or Pace()
    pause, failures = pace.first, 0
    while not stop.wait(pause):
        failures = 0 if look(storage, clock, metrics) else failures + 1
        pause = pace.after(failures)


def look(storage: Storage, clock: Callable[[], datetime], metrics: Metrics) -> bool:
    """Checks the whole fleet and what dead processes left; whether all of it succeeded."""
    guard = Guard(metrics)
    with guard.alone("uses", ""):
        settle_all(storage)
    with guard.alone("outlooks", ""):
        update_outlooks(storage, clock(), guard.alone)
    with guard.alone("due dates", ""):
        flag_overdue(storage, clock(), guard.alone)
    with guard.alone("stands", ""):
        flag_shifted_stands(storage, clock(), guard.alone)
    with guard.alone("groups", ""):
        ask_for_outdated(storage, clock, guard.alone)
    with guard.alone("half-written files", ""):
        storage.files.sweep()
    with guard.alone("files of jobs", ""):
        drop_expired(storage, clock())
    with guard.alone("files that wait", ""):
        sweep_waiting(storage, clock())
        drop_stale(storage.files, clock())
    return not guard.failed


def update_outlooks(storage: Storage, now: datetime, alone: Alone = plainly) -> int:
    """Updates every outlook to the current drift of its type, and returns the number of updated ones.

    A unit's contribution to its type does not depend on the type, so one round is enough, and the outlooks of a fleet
    do not depend on the order of its sessions; where no unit has contributed yet, after an upgrade of the store, it
    takes two.
    """
    with storage.database.reading() as store:
        serials = Units(store).every()
    done = 0
    for serial in serials:
        with alone("outlooks", serial):
            done += _updated(storage, serial, now)
    return done


def _updated(storage: Storage, serial: str, now: datetime) -> bool:
    with storage.database.reading() as store:
        if not _is_stale(store, serial):
            return False
    with storage.database.writing() as store:
        Units(store).hold(serial)
        WorkQueue(store, WorkKind.OUTLOOK).enqueue_again(serial, now)
    date_one(storage, serial, now)
    return True


def _is_stale(store: Store, serial: str) -> bool:
    """A unit without an accepted session has no outlook; one whose outlook is requested is left to the background
    process."""
    summary = Fleet(store).unit(serial)
    if summary is None or summary.last_session is None or summary.is_undated:
        return False
    unit = Units(store).key(serial)
    return Outlooks(store).rests_on(unit) != digest(of_type(store, unit))


MISSING_AT_ONCE = 500
"""Sessions per query."""


def ask_for_missing(storage: Storage, clock: Callable[[], datetime], metrics: Metrics, bell: Bell, stop: Event) -> None:
    """Requests, at the start, the diagnosis of every session that has none, or at which an older version failed; failed
    work is retried.
    """
    last_session = ""
    with Guard(metrics).alone(DIAGNOSES.name, ""):
        with storage.database.writing() as store:
            Failures(store).try_again()
        while not stop.is_set():
            with storage.database.reading() as store:
                missing = Sessions(store).without_diagnosis(last_session, MISSING_AT_ONCE, VERSION)
            if not missing:
                return
            with storage.database.writing() as store:
                WorkQueue(store, WorkKind.DIAGNOSIS).enqueue_once(missing, clock())
            bell.ring()
            last_session = missing[-1]


def ask_for_outdated(storage: Storage, clock: Callable[[], datetime], alone: Alone = plainly) -> int:
    """Requests groups whose answer does not match their current sessions, as after an upgrade; returns the number."""
    with storage.database.reading() as store:
        groups = Groups(store).every()
    count = 0
    for group in groups:
        with alone("groups", group.name):
            with storage.database.reading() as store:
                is_outdated = (
                    current(store, group) is None and WorkQueue(store, WorkKind.GROUP).get(group.place) is None
                )
            if is_outdated:
                count += 1
                with storage.database.writing() as store:
                    WorkQueue(store, WorkKind.GROUP).enqueue_each((group.place,), clock())
    return count


DERIVE_EVERY = 2.0
"""Seconds between two checks: a person who changed a record waits for it."""
DERIVE_RETRY = 60.0
"""Seconds after a check in which something failed: a permanent failure is reported once a minute."""
DERIVED_AT_ONCE = 10
"""Sessions that are judged before they are stored together."""


def derive_pending(
    storage: Storage, coverage_factor: float, clock: Callable[[], datetime], metrics: Metrics, stop: Event
) -> None:
    """Derives pending verdicts until ``stop`` is set; what a crash interrupts is still pending at the next start, and a
    unit at which something fails waits for the next check."""
    pause = DERIVE_EVERY
    while not stop.wait(pause):
        guard = Guard(metrics)
        with guard.alone("derivations", ""):
            derive_waiting(storage, coverage_factor, clock, stop, guard.alone)
        pause = DERIVE_RETRY if guard.failed else DERIVE_EVERY


def derive_waiting(
    storage: Storage, coverage_factor: float, clock: Callable[[], datetime], stop: Event, alone: Alone = plainly
) -> None:
    """Derives all pending verdicts, unit after unit."""
    with storage.database.reading() as store:
        serials = Derivations(store).waiting()
    for serial in serials:
        with alone("derivations", serial), kept(_failed_at(storage, serial, clock)):
            remaining = 1
            while remaining and not stop.is_set():
                deriving = Deriving(storage.files, coverage_factor, clock())
                remaining = derive_waiting_of(storage, deriving, serial, DERIVED_AT_ONCE)
            date(storage, deriving, serial)


def _failed_at(storage: Storage, serial: str, clock: Callable[[], datetime]) -> Callable[[str], None]:
    def keep(why: str) -> None:
        with storage.database.writing() as store:
            WorkQueue(store, WorkKind.DERIVATION).add_failed(serial, why, clock())

    return keep
