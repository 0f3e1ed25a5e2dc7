"""The diagnosis of a session, the outlook of a unit and what a group of sessions shows, for whoever reads them: awaited
where they are made beside the requests, and else made.
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
from service.fleet.changes import summarise_all
from service.groups.records import Group, GroupAnswer, Level
from service.groups.store import Groups
from service.kit.bell import Bell
from service.kit.failure import group_failed
from service.kit.guard import Guard
from service.kit.metrics import Metrics
from service.queue.records import Waiting, WorkKind
from service.queue.store import WorkQueue
from service.records import refresh_group
from service.records.diagnose import diagnose, give_up, known_of
from service.records.follow import date_one
from service.records.refresh_group import current
from service.sessions.store import Sessions
from service.settings import VERSION
from service.storage import Storage
from service.work.kinds import DIAGNOSES, GROUPS, OUTLOOKS, PUT_OFF, SUMMARIES

PATIENCE = 15.0
"""Seconds that a program is let wait: a usual diagnosis takes one or two, and a few may be before it."""
GLANCE = 0.3
"""Seconds that a page is let wait: it follows by itself."""
LOOK_EVERY = 0.25
"""Seconds between two looks at what another service may have made."""
MOST_WAITING = 8
"""Requests that wait at a time, of the 40 that are answered at once; others are asked back."""

LEASE = timedelta(minutes=2)
"""Of a reader, who does not say again that he is at it: longer than nearly all diagnoses take."""
MOST_WAITING_FOR_GROUPS = 4
"""Requests that wait at a time, of the 40 that are answered at once; others are asked back."""
T = TypeVar("T")
"""What is read."""


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
        """The diagnosis of a session; None while it is still being made, NotFoundError where there is no session."""
        known, asked = self._look(id)
        if known is not None:
            return known
        if self._is_left_to_readers(asked):
            return self._made(id)
        self.bell.hurry(id)
        if not self._places.acquire(blocking=False):
            return None
        try:
            return self._awaited(id, patience)
        finally:
            self._places.release()

    def made(self, id: str) -> StoredDiagnosis:
        """The diagnosis of a session for what rests on it, where the program failed one that says so.

        PendingError while it is still being made.
        """
        found = self.read(id)
        if found is None:
            raise PendingError(STILL_MADE)
        return found

    def until_dated(self, serial: str, patience: float = PATIENCE) -> bool:
        """Waits for the outlook of a unit whose history has changed, or makes it where nobody else does; whether it is
        as the history says."""
        if not self._is_undated(serial):
            return True
        if not self.workers:
            return self._date(serial)
        if not self._places.acquire(blocking=False):
            return False
        try:
            return bool(_awaited(self.bell, lambda: not self._is_undated(serial) or None, patience))
        finally:
            self._places.release()

    def until_summarised(self) -> None:
        """Makes what pages of the fleet read, where nobody else does."""
        if self.workers:
            return
        with self.storage.database.reading() as store:
            is_asked = WorkQueue(store, WorkKind.SUMMARY).count() > 0
        if is_asked:
            with Guard(self.metrics).at_request(SUMMARIES.name, ""):
                summarise_all(self.storage, self.clock())

    def _date(self, serial: str) -> bool:
        """Here; where that fails it is kept, and nobody waits for it."""
        guard = Guard(self.metrics)
        with guard.at_request(OUTLOOKS.name, serial):
            date_one(self.storage, serial, self.clock())
        return not guard.failed

    def _is_undated(self, serial: str) -> bool:
        with self.storage.database.reading() as store:
            return WorkQueue(store, WorkKind.OUTLOOK).is_coming(serial)

    def _look(self, id: str) -> tuple[StoredDiagnosis | None, Waiting | None]:
        with self.storage.database.reading() as store:
            Sessions(store).get(id)
            return known_of(store, id), WorkQueue(store, WorkKind.DIAGNOSIS).get(id)

    def _is_left_to_readers(self, asked: Waiting | None) -> bool:
        """Where nobody makes it, or where it failed: then the reader is told why."""
        return not self.workers or asked is None or asked.not_before is not None

    def _awaited(self, id: str, patience: float) -> StoredDiagnosis | None:
        return _awaited(self.bell, lambda: self._look(id)[0], patience)

    def _made(self, id: str) -> StoredDiagnosis | None:
        """Here, unless somebody is at it; where the program fails that is kept, and whoever reads is told."""
        now = self.clock()
        with self.storage.database.writing() as store:
            queue = WorkQueue(store, WorkKind.DIAGNOSIS)
            queue.ask_once((id,), now)
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
                queue.hold_up(id, str(fault))
                queue.put_off(id, now + PUT_OFF)
            raise


@dataclass(frozen=True)
class GroupReader:
    """Reads what groups show, of one service."""

    storage: Storage
    clock: Callable[[], datetime]
    bell: Bell
    metrics: Metrics
    workers: int
    """Processes of this service that make answers; 0 where each is made when it is read."""
    places: BoundedSemaphore = field(default_factory=lambda: BoundedSemaphore(MOST_WAITING_FOR_GROUPS))

    def read(self, level: Level, name: str, patience: float = PATIENCE) -> GroupAnswer | None:
        """The answer of a group for its sessions of now; None while it is still being made, NotFoundError where there
        is no such unit, unit type or stand."""
        with self.storage.database.reading() as store:
            group = Groups(store).find(level, name)
            known, asked = current(store, group), WorkQueue(store, WorkKind.GROUP).get(group.place)
        if known is not None:
            return known
        if not self.workers:
            return self._made(group)
        if asked is not None and asked.failed:
            return GroupAnswer("", 0, group_failed(asked.failed), "", None, VERSION, self.clock())
        if asked is None:
            with self.storage.database.writing() as store:
                WorkQueue(store, WorkKind.GROUP).ask_each((group.place,), self.clock())
            self.bell.ring()
        if not self.places.acquire(blocking=False):
            return None
        try:
            return _awaited(self.bell, lambda: self._known(group), patience)
        finally:
            self.places.release()

    def _made(self, group: Group) -> GroupAnswer | None:
        """Here, without the sessions at which the program fails; where it fails at the answer itself that is kept."""
        guard = Guard(self.metrics)
        for tried in range(GROUPS.most):
            with guard.at_request(GROUPS.name, group.name):
                refresh_group.refresh_group(self.storage, group, self.clock())
            if guard.failed == tried:
                break
        else:
            refresh_group.give_up(self.storage, group, self.clock())
        return self._known(group)

    def _known(self, group: Group) -> GroupAnswer | None:
        with self.storage.database.reading() as store:
            return current(store, group)


def _awaited(bell: Bell, look: Callable[[], T | None], patience: float) -> T | None:
    """What is looked for, as soon as it is there; None where that takes too long."""
    end = monotonic() + patience
    while True:
        rung, found, left = bell.rung, look(), end - monotonic()
        if found is not None or left <= 0:
            return found
        bell.wait(rung, min(left, LOOK_EVERY))
