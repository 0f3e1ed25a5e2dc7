"""The diagnosis of a session and the outlook of a unit for whoever reads them: awaited where they are made beside the
requests, and else made.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from datetime import datetime, timedelta
from threading import BoundedSemaphore
from time import monotonic

from estimator.errors import SessionError
from service.diagnosis.records import StoredDiagnosis
from service.diagnosis.words.diagnosis import STILL_MADE
from service.errors import PendingError, ServiceError
from service.fleet.changes import summarise_all
from service.kit.bell import Bell
from service.kit.guard import Guard
from service.kit.metrics import Metrics
from service.queue.records import Waiting, WorkKind
from service.queue.store import WorkQueue
from service.records.diagnose import diagnose, give_up, known_of
from service.records.refresh_outlooks import date_one
from service.sessions.store import Sessions
from service.storage import Storage
from service.work.kinds import DIAGNOSES, OUTLOOKS, PUT_OFF, SUMMARIES

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
            return self._awaited(id, monotonic() + patience)
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
            return self._dated(serial, monotonic() + patience)
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

    def _dated(self, serial: str, end: float) -> bool:
        while True:
            rung = self.bell.rung
            if not self._is_undated(serial):
                return True
            left = end - monotonic()
            if left <= 0:
                return False
            self.bell.wait(rung, min(left, LOOK_EVERY))

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

    def _awaited(self, id: str, end: float) -> StoredDiagnosis | None:
        while True:
            rung = self.bell.rung
            known, _ = self._look(id)
            left = end - monotonic()
            if known is not None or left <= 0:
                return known
            self.bell.wait(rung, min(left, LOOK_EVERY))

    def _made(self, id: str) -> StoredDiagnosis | None:
        """Here, unless somebody is at it; where the program fails that is kept, and whoever reads is told."""
        now = self.clock()
        with self.storage.database.writing() as store:
            queue = WorkQueue(store, WorkKind.DIAGNOSIS)
            queue.ask_once((id,), now)
            is_ours = queue.claim(id, now, now + LEASE) is not None
        if not is_ours:
            return self._awaited(id, monotonic() + PATIENCE)
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
