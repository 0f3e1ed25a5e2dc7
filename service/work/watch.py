"""Work beside the requests that nobody claims: the fleet is looked at now and then, what is missing is asked for, and
what a change of records or of a model left is derived again."""

from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime
from threading import Event

from service.fleet.store import Fleet
from service.groups.store import Groups
from service.jobs.changes import drop_outlived
from service.jobs.store import Failures
from service.judging.store import Derivations
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
    """How often the fleet is looked at, s."""

    first: float = 20.0
    """After the start, which has other work."""
    every: float = 3600.0
    """Between two looks: dates fall due by the day."""
    retry: float = 60.0
    """After a look in which something failed; twice as long after each further one, up to `every`. A database that
    restarts is back within a minute, and what fails for good is not told more often than it is looked at."""

    def after(self, failures: int) -> float:
        """The pause after so many looks in a row in which something failed."""
        return self.every if not failures else min(self.every, self.retry * 2 ** min(failures - 1, 20))


def watch_fleet(
    storage: Storage, clock: Callable[[], datetime], metrics: Metrics, stop: Event, pace: Pace | None = None
) -> None:
    """Looks at every outlook, due date and stand now and then until ``stop`` is set."""
    pace = pace or Pace()
    pause, failures = pace.first, 0
    while not stop.wait(pause):
        failures = 0 if look(storage, clock, metrics) else failures + 1
        pause = pace.after(failures)


def look(storage: Storage, clock: Callable[[], datetime], metrics: Metrics) -> bool:
    """One look at the whole fleet and at what dead processes left; whether all of it could be looked at."""
    guard = Guard(metrics)
    with guard.alone("outlooks", ""):
        relearn(storage, clock(), guard.alone)
    with guard.alone("due dates", ""):
        flag_overdue(storage, clock(), guard.alone)
    with guard.alone("stands", ""):
        flag_shifted_stands(storage, clock(), guard.alone)
    with guard.alone("groups", ""):
        ask_for_outdated(storage, clock, guard.alone)
    with guard.alone("half-written files", ""):
        storage.files.sweep()
    with guard.alone("files of jobs", ""):
        drop_outlived(storage, clock())
    with guard.alone("files that wait", ""):
        sweep_waiting(storage, clock())
        drop_stale(storage.files, clock())
    return not guard.failed


def relearn(storage: Storage, now: datetime, alone: Alone = plainly) -> int:
    """Brings every outlook up to what its type tells by now, and returns how many that were.

    What a unit tells of its type does not depend on the type, so one round is enough, and the outlooks of a fleet do
    not depend on the order in which its sessions came; where no unit has told yet, after the store was brought up to
    date, it takes two.
    """
    with storage.database.reading() as store:
        serials = Units(store).every()
    done = 0
    for serial in serials:
        with alone("outlooks", serial):
            done += _relearned(storage, serial, now)
    return done


def _relearned(storage: Storage, serial: str, now: datetime) -> bool:
    with storage.database.reading() as store:
        if not _is_stale(store, serial):
            return False
    with storage.database.writing() as store:
        Units(store).hold(serial)
        WorkQueue(store, WorkKind.OUTLOOK).ask_again(serial, now)
    date_one(storage, serial, now)
    return True


def _is_stale(store: Store, serial: str) -> bool:
    """A unit of which no session is accepted has no outlook; one whose outlook is asked for is left to whoever makes
    it, in a process of its own."""
    summary = Fleet(store).unit(serial)
    if summary is None or summary.last_session is None or summary.is_undated:
        return False
    unit = Units(store).key(serial)
    return Outlooks(store).rests_on(unit) != digest(of_type(store, unit))


MISSING_AT_ONCE = 500
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
                missing = Sessions(store).without_diagnosis(last, MISSING_AT_ONCE, VERSION)
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


DERIVE_EVERY = 2.0
"""Seconds between two looks: a person who changed a record waits for it."""
DERIVE_RETRY = 60.0
"""Seconds after a look in which something failed: what fails for good is told once a minute."""
DERIVED_AT_ONCE = 10
"""Sessions that are worked out before they are put down together."""


def derive_pending(
    storage: Storage, coverage_factor: float, clock: Callable[[], datetime], metrics: Metrics, stop: Event
) -> None:
    """Judges what waits until ``stop`` is set; what a crash interrupts still waits at the next start, and a unit on
    which something fails waits for the next look."""
    pause = DERIVE_EVERY
    while not stop.wait(pause):
        guard = Guard(metrics)
        with guard.alone("derivations", ""):
            derive_waiting(storage, coverage_factor, clock, stop, guard.alone)
        pause = DERIVE_RETRY if guard.failed else DERIVE_EVERY


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
        left = derive_waiting_of(storage, way, serial, DERIVED_AT_ONCE)
    date(storage, way, serial)
