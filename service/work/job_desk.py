"""The desk for long jobs: done in the background, or at once where no process works there."""

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
    """Long jobs of one service."""

    clock: Callable[[], datetime]
    bell: Bell
    metrics: Metrics
    coverage_factor: float
    workers: int
    """Processes of this service that do them; 0 where a job is done when it is requested."""

    def ask(self, storage: Storage, new: NewJob) -> Job:
        """Requests a job, and returns its current state; one that was interrupted goes on."""
        job = ask_job(storage, new, self.clock())
        while not self.workers and self._did_piece(storage, JOBS, job, lambda now: self._piece(storage, job, now)):
            pass
        return self._announced(storage, job)

    def take_in(self, reception: Reception, file: SentFile, person: Person) -> Job:
        """Requests a job for a long file, and returns its current state."""
        storage = reception.storage
        job = ask_upload(storage, file, person, uuid4().hex, self.clock())
        if not self.workers:
            self._did_piece(storage, UPLOADS, job, lambda now: take_in(reception, job.id, now))
        return self._announced(storage, job)

    def try_again(self, storage: Storage, now: datetime, who: str) -> int:
        """Retries everything that failed; returns the number of pieces."""
        count = retry_failed(storage, now, who)
        self.bell.ring()
        return count

    def _announced(self, storage: Storage, job: Job) -> Job:
        self.bell.ring()
        with storage.database.reading() as store:
            return Jobs(store).get(job.id)

    def _piece(self, storage: Storage, job: Job, now: datetime) -> None:
        work_piece(storage, job.id, now, self.coverage_factor)

    def _did_piece(self, storage: Storage, kind: Kind, job: Job, make: Callable[[datetime], None]) -> bool:
        """Does a piece, unless another process has it or the job has ended; returns whether it was done here. A
        foreseen failure is raised to the requester; any other ends this piece alone.
        """
        key, now, guard = str(job.id), self.clock(), Guard(self.metrics)
        with storage.database.writing() as store:
            if kind.queue(store).claim(key, now, now + LEASE) is None:
                return False
        try:
            with guard.at_request(kind.name, key):
                make(now)
        except FORESEEN as fault:
            with storage.database.writing() as store:
                kind.queue(store).record_failure(key, str(fault))
                kind.queue(store).put_off(key, None)
            raise
        if guard.failed:
            kind.end(storage, key, now)
        return True
