"""Work beside the requests: outlooks, due dates and stands, looked at now and then, whatever fails on one of them."""

from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime
from threading import Event

from service.jobs.changes import drop_outlived
from service.kit.guard import Guard
from service.kit.metrics import Metrics
from service.records.flagging.overdue_units import flag_overdue
from service.records.flagging.shifted_stands import flag_shifted_stands
from service.storage import Storage
from service.storage.aside import drop_stale
from service.uploads.take_in import sweep_waiting
from service.work.asking import ask_for_outdated
from service.work.outlooks import relearn


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
