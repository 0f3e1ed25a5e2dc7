"""The diagnosis of a session, the outlook of a unit and the joint diagnosis of a group: awaited where they are made in
the background, else made at once.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from datetime import datetime, timedelta
from threading import BoundedSemaphore
from time import monotonic
from typing import TypeVar

from estimator.errors import SessionError
from service.diagnosis.records import StoredDiagnosis
from service.diagnosis.words.diagnosis import STILL_MADE
from service.errors import PendingError, ServiceError
from service.fleet.store import Fleet
from service.groups.records import Group, GroupAnswer, Level
from service.groups.store import Groups
from service.kit.bell import Bell
from service.kit.failure import group_failed
from service.kit.guard import Guard
from service.kit.metrics import Metrics
from service.queue.records import Rank, Waiting, WorkKind
from service.queue.store import WorkQueue
from service.records import refresh_group
from service.records.diagnose import diagnose, give_up, known_of
from service.records.follow import date_one
from service.records.refresh_group import current
from service.sessions.store import Sessions
from service.settings import VERSION
from service.storage import Storage
from service.work.kinds import DIAGNOSES, GROUPS, OUTLOOKS, PUT_OFF

PATIENCE = 15.0
"""Seconds that a program waits: a usual diagnosis takes one or two, and a few may be before it."""
PAGE_PATIENCE = 0.3
"""Seconds that a page waits: it refreshes by itself."""
POLL_SECONDS = 0.25
"""Seconds between two checks for results of other services."""
MOST_WAITING = 8
"""Requests that may wait, of the 40 that are answered at once; others are rejected with Retry-After."""

LEASE = timedelta(minutes=2)
"""Lease of a reader, which is not extended: longer than nearly all diagnoses take."""
MOST_WAITING_FOR_GROUPS = 4
"""Requests that may wait, of the 40 that are answered at once; others are rejected with Retry-After."""
T = TypeVar("T")


@dataclass(frozen=True)
class Reader:
    """Reads diagnoses, and waits for outlooks, of one service."""

    storage: Storage
    clock: Callable[[], datetime]
    bell: Bell
    metrics: Metrics
    coverage_factor: float
    workers: int
    """Processes of this service that make diagnoses; 0 where each is made when it is read."""
    _places: BoundedSemaphore = field(default_factory=lambda: BoundedSemaphore(MOST_WAITING))

    def read(self, id: str, patience: float = PATIENCE) -> StoredDiagnosis | None:
        """The diagnosis of a session; None while it is being made, NotFoundError where there is no session."""
        known, request = self._look(id)
        if known is not None:
            return known
        if self._is_left_to_readers(request):
            return self._made(id)
        hurry(self.storage, self.bell, WorkKind.DIAGNOSIS, id)
        if not self._places.acquire(blocking=False):
            return None
        try:
            return self._awaited(id, patience)
        finally:
            self._places.release()

    def made(self, id: str) -> StoredDiagnosis:
        """The diagnosis of a session for results that depend on it, or why the program failed at it.

        PendingError while it is being made.
        """
        diagnosis = self.read(id)
        if diagnosis is None:
            raise PendingError(STILL_MADE)
        return diagnosis

    def until_dated(self, serial: str, patience: float = PATIENCE) -> bool:
        """Waits for the outlook of a unit whose history has changed, or makes it where no process does; whether it is
        up to date."""
        if not self._is_undated(serial):
            return True
        if not self.workers:
            return self._date(serial)
        hurry(self.storage, self.bell, WorkKind.OUTLOOK, serial)
        if not self._places.acquire(blocking=False):
            return False
        try:
            return bool(_awaited(self.bell, lambda: not self._is_undated(serial) or None, patience))
        finally:
            self._places.release()

    def until_summarised(self, patience: float = PAGE_PATIENCE) -> None:
        """Waits for the summaries of the fleet where the service itself makes them: those of a small one are there at
        once, and of a large one the previous ones are shown."""
        if self.workers or self._is_summarised() or not self._places.acquire(blocking=False):
            return
        try:
            self.bell.ring()
            _awaited(self.bell, lambda: self._is_summarised() or None, patience)
        finally:
            self._places.release()

    def look_at(self, id: str) -> None:
        """Somebody looks at a session: its diagnosis comes first."""
        if self.workers:
            hurry(self.storage, self.bell, WorkKind.DIAGNOSIS, id)

    def look_at_unit(self, serial: str) -> None:
        """Somebody looks at a unit: its outlook and the diagnosis of its latest session come first."""
        if not self.workers:
            return
        with self.storage.database.reading() as store:
            summary = Fleet(store).unit(serial)
        if summary is None or summary.last_session is None:
            return
        hurry(self.storage, self.bell, WorkKind.OUTLOOK, serial)
        self.look_at(summary.last_session)

    def _is_summarised(self) -> bool:
        with self.storage.database.reading() as store:
            return not WorkQueue(store, WorkKind.SUMMARY).any_pending()

    def _date(self, serial: str) -> bool:
        """Makes the outlook here; a failure is recorded, and not awaited."""
        guard = Guard(self.metrics)
        with guard.at_request(OUTLOOKS.name, serial):
            date_one(self.storage, serial, self.clock())
        return not guard.failed

    def _is_undated(self, serial: str) -> bool:
        with self.storage.database.reading() as store:
            return WorkQueue(store, WorkKind.OUTLOOK).is_pending(serial)

    def _look(self, id: str) -> tuple[StoredDiagnosis | None, Waiting | None]:
        with self.storage.database.reading() as store:
            Sessions(store).get(id)
            return known_of(store, id), WorkQueue(store, WorkKind.DIAGNOSIS).get(id)

    def _is_left_to_readers(self, request: Waiting | None) -> bool:
        """Whether no process makes it, or it failed: then the reader gets the reason."""
        return not self.workers or request is None or request.not_before is not None

    def _awaited(self, id: str, patience: float) -> StoredDiagnosis | None:
        return _awaited(self.bell, lambda: self._look(id)[0], patience)

    def _made(self, id: str) -> StoredDiagnosis | None:
        """Makes it here, unless another process has it; a failure of the program is recorded and shown."""
        now = self.clock()
        with self.storage.database.writing() as store:
            queue = WorkQueue(store, WorkKind.DIAGNOSIS)
            queue.enqueue_once((id,), now)
            is_ours = queue.claim(id, now, now + LEASE) is not None
        if not is_ours:
            return self._awaited(id, PATIENCE)
        guard = Guard(self.metrics)
        with guard.at_request(DIAGNOSES.name, id):
            self._diagnose(id, now)
        if guard.failed:
            give_up(self.storage, id, now)
        return self._look(id)[0]

    def _diagnose(self, id: str, now: datetime) -> None:
        try:
            diagnose(self.storage, id, now, self.coverage_factor)
        except (ServiceError, SessionError) as fault:
            with self.storage.database.writing() as store:
                queue = WorkQueue(store, WorkKind.DIAGNOSIS)
                queue.record_failure(id, str(fault))
                queue.put_off(id, now + PUT_OFF)
            raise


@dataclass(frozen=True)
class GroupReader:
    """Reads joint diagnoses, for one service."""

    storage: Storage
    clock: Callable[[], datetime]
    bell: Bell
    metrics: Metrics
    workers: int
    """Processes of this service that make answers; 0 where each is made when it is read."""
    places: BoundedSemaphore = field(default_factory=lambda: BoundedSemaphore(MOST_WAITING_FOR_GROUPS))

    def read(self, level: Level, name: str, patience: float = PATIENCE) -> GroupAnswer | None:
        """The answer of a group for its current sessions; None while it is being made, NotFoundError where there is no
        such unit, unit type or stand."""
        with self.storage.database.reading() as store:
            group = Groups(store).find(level, name)
            known, request = current(store, group), WorkQueue(store, WorkKind.GROUP).get(group.place)
        if known is not None:
            return known
        if not self.workers:
            return self._made(group)
        if request is not None and request.failed:
            return GroupAnswer("", 0, group_failed(request.failed), "", None, VERSION, self.clock())
        if request is None:
            with self.storage.database.writing() as store:
                WorkQueue(store, WorkKind.GROUP).enqueue_each((group.place,), self.clock())
        hurry(self.storage, self.bell, WorkKind.GROUP, group.place)
        if not self.places.acquire(blocking=False):
            return None
        try:
            return _awaited(self.bell, lambda: self._known(group), patience)
        finally:
            self.places.release()

    def _made(self, group: Group) -> GroupAnswer | None:
        """Makes it here, without the sessions at which the program fails; a failure of the answer is recorded."""
        guard = Guard(self.metrics)
        for attempt in range(GROUPS.most):
            with guard.at_request(GROUPS.name, group.name):
                refresh_group.refresh_group(self.storage, group, self.clock())
            if guard.failed == attempt:
                break
        else:
            refresh_group.give_up(self.storage, group, self.clock())
        return self._known(group)

    def _known(self, group: Group) -> GroupAnswer | None:
        with self.storage.database.reading() as store:
            return current(store, group)


def hurry(storage: Storage, bell: Bell, kind: WorkKind, key: str) -> None:
    """Puts a piece of work first because somebody looks at what shows it."""
    with storage.database.reading() as store:
        request = WorkQueue(store, kind).get(key)
    if request is not None and request.rank > Rank.AWAITED:
        with storage.database.writing() as store:
            WorkQueue(store, kind).hurry(key)
        bell.ring()


def _awaited(bell: Bell, look: Callable[[], T | None], patience: float) -> T | None:
    """The result as soon as it is there; None after the time limit."""
    end = monotonic() + patience
    while True:
        rung, result, remaining = bell.rung, look(), end - monotonic()
        if result is not None or remaining <= 0:
            return result
        bell.wait(rung, min(remaining, POLL_SECONDS))
