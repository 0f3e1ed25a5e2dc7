"""Where long work is asked for: done beside the requests, or at once where no process works there."""

from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime
from uuid import uuid4

from service.jobs.changes import ask_job, retry_failed
from service.jobs.records import Job, NewJob
from service.jobs.store import Jobs
from service.kit.bell import Bell
from service.kit.guard import FORESEEN, Guard
from service.kit.metrics import Metrics
from service.kit.person import Person
from service.records.reception import Reception
from service.sessions.sent import SentFile
from service.storage import Storage
from service.uploads.take_in import ask_upload, take_in
from service.work.kinds import JOBS, LEASE, UPLOADS, Kind, work_piece


@dataclass(frozen=True)
class JobDesk:
    """Of one service."""

    clock: Callable[[], datetime]
    bell: Bell
    metrics: Metrics
    coverage_factor: float
    workers: int
    """Processes of this service that do it; 0 where it is done when it is asked for."""

    def ask(self, storage: Storage, new: NewJob) -> Job:
        """The job, as it stands now; asked for again, one that was left in the middle goes on."""
        job = ask_job(storage, new, self.clock())
        while not self.workers and self._is_worked(storage, JOBS, job, lambda now: self._piece(storage, job, now)):
            pass
        return self._rung(storage, job)

    def take_in(self, reception: Reception, file: SentFile, person: Person) -> Job:
        """The job that takes in a long file, as it stands now."""
        storage = reception.storage
        job = ask_upload(storage, file, person, uuid4().hex, self.clock())
        if not self.workers:
            self._is_worked(storage, UPLOADS, job, lambda now: take_in(reception, job.id, now))
        return self._rung(storage, job)

    def try_again(self, storage: Storage, now: datetime, who: str) -> int:
        """Asks anew for everything that failed; returns how much that is."""
        count = retry_failed(storage, now, who)
        self.bell.ring()
        return count

    def _rung(self, storage: Storage, job: Job) -> Job:
        self.bell.ring()
        with storage.database.reading() as store:
            return Jobs(store).get(job.id)

    def _piece(self, storage: Storage, job: Job, now: datetime) -> None:
        work_piece(storage, job.id, now, self.coverage_factor)

    def _is_worked(self, storage: Storage, kind: Kind, job: Job, make: Callable[[datetime], None]) -> bool:
        """Makes a piece, unless another is at it or the job has ended; whether it was made here. Whoever asked is told
        what is foreseen, and what is not costs this piece alone."""
        key, now, guard = str(job.id), self.clock(), Guard(self.metrics)
        with storage.database.writing() as store:
            if kind.queue(store).claim(key, now, now + LEASE) is None:
                return False
        try:
            with guard.at_request(kind.name, key):
                make(now)
        except FORESEEN as fault:
            with storage.database.writing() as store:
                kind.queue(store).hold_up(key, str(fault))
                kind.queue(store).put_off(key, None)
            raise
        if guard.failed:
            kind.end(storage, key, now)
        return True
