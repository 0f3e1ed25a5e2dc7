"""Where long work is asked for: done beside the requests, or at once where no process works there."""

from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime
from uuid import uuid4

from service.jobs.changes import ask_job
from service.jobs.records import Job, NewJob
from service.jobs.retry import retry_failed
from service.jobs.store import Jobs
from service.kit.arriving_files import SentFile
from service.kit.bell import Bell
from service.kit.guard import FORESEEN, Guard
from service.kit.metrics import Metrics
from service.kit.person import Person
from service.records.reception import Reception
from service.storage import Storage
from service.uploads.take_in import ask_upload, take_in
from service.work.job_pieces import skip_piece, work_piece
from service.work.loop import LEASE


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
        if not self.workers:
            self._work_through(storage, job.id)
        self.bell.ring()
        with storage.database.reading() as store:
            return Jobs(store).get(job.id)

    def take_in(self, reception: Reception, file: SentFile, person: Person) -> Job:
        """The job that takes in a long file, as it stands now."""
        storage = reception.storage
        job = ask_upload(storage, file, person, uuid4().hex, self.clock())
        if not self.workers:
            take_in(reception, job.id, self.clock())
        self.bell.ring()
        with storage.database.reading() as store:
            return Jobs(store).get(job.id)

    def try_again(self, storage: Storage, now: datetime, who: str) -> int:
        """Asks anew for everything that failed; returns how much that is."""
        count = retry_failed(storage, now, who)
        self.bell.ring()
        return count

    def _work_through(self, storage: Storage, id: int) -> None:
        while True:
            now = self.clock()
            with storage.database.writing() as store:
                begun = Jobs(store).claim(id, now, now + LEASE)
            if begun is None:
                return
            self._work(storage, id, now)

    def _work(self, storage: Storage, id: int, now: datetime) -> None:
        """A piece; whoever asked is told what is foreseen, and what is not costs this piece alone."""
        guard = Guard(self.metrics)
        try:
            with guard.at_request("jobs", str(id)):
                work_piece(storage, id, now, self.coverage_factor)
        except FORESEEN:
            with storage.database.writing() as store:
                Jobs(store).put_off(id, None)
            raise
        if guard.failed:
            skip_piece(storage, id, now)
