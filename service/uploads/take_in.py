"""Flow: a long file that was received completely → a job → stored or refused like any upload, in the background.

The file is stored under a temporary name before its job is recorded, and removed after the job has ended: a service
that is killed at any moment leaves a job that another one resumes, or a file without a job, which is swept. The job
ends in the transaction that stores the session or records the refusal, so each exists once.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from datetime import datetime

from service.errors import (
    BusyError,
    ConflictError,
    DamagedError,
    ForbiddenError,
    NotFoundError,
    RefusedError,
    ServiceError,
)
from service.ingest.apart import reports_progress_to
from service.ingest.checked import plain_filename
from service.jobs.changes import UploadHooks, require_room
from service.jobs.records import KILOBYTE, Job, JobFailure, JobKind, NewJob
from service.jobs.store import Jobs
from service.kit.person import Person
from service.records.reception import Reception
from service.sessions.records import Receipt
from service.sessions.sent import Received, Sent, SentFile
from service.sessions.store import Sessions
from service.storage import Storage
from service.storage.audit import Audit
from service.storage.files import content_hash
from service.storage.queries import Store
from service.storage.waiting import drop_orphaned, drop_waiting, give_back, put_waiting, waiting_file
from service.uploads.receive import receive, receive_mapped, refuse

FINAL = (NotFoundError, ConflictError, ForbiddenError, DamagedError)
"""Errors that another attempt would raise too."""


def is_long(storage: Storage, file: SentFile, longer_than: int) -> bool:
    """Whether a file is to be processed by a job: larger than the limit, and not stored already."""
    if len(file.content) <= longer_than:
        return False
    if file.replaces is not None or file.mapping is not None:
        return True
    with storage.database.reading() as store:
        return Sessions(store).by_hash(content_hash(file.content)) is None


class EndedError(ServiceError):
    """The job was cancelled or ended by another process: processing stops."""


def ask_upload(storage: Storage, file: SentFile, person: Person, place: str, now: datetime) -> Job:
    """Stores a file under its ``place`` and a job for it; the same file sent again is the same job."""
    if file.replaces is not None:
        with storage.database.reading() as store:
            Sessions(store).get(file.replaces.session)
    digest = content_hash(file.content)
    sent = Sent(place, digest, len(file.content), person.account, **file.stated())
    put_waiting(storage.files, place, file.content)
    new = NewJob(JobKind.UPLOAD, person.signs("crew"), person.login, subject=plain_filename(file.filename), sent=sent)
    try:
        with storage.database.writing() as store:
            existing = next((job for job in Jobs(store).sending(digest) if _is_same(job, new)), None)
            job = _added(store, new, now) if existing is None else existing
    except BusyError:
        give_back(storage.files, place, file.content)
        raise
    if existing is not None:
        drop_waiting(storage.files, place)
    return job


def _is_same(job: Job, new: NewJob) -> bool:
    assert job.sent is not None
    assert new.sent is not None
    return replace(job.sent, place=new.sent.place) == new.sent


def _added(store: Store, new: NewJob, now: datetime) -> Job:
    require_room(store)
    assert new.sent is not None
    job = Jobs(store).add(new, -(-new.sent.size // KILOBYTE), now)
    Audit(store).write(now, new.who, "receive", new.subject, {"job": job.id, "sha256": new.sent.sha256})
    return job


@dataclass(frozen=True)
class _JobHooks:
    """Hooks of an upload that update its job."""

    storage: Storage
    id: int
    now: datetime
    tick: Callable[[], None]

    def read_on(self, done: int, times: int) -> None:
        """Records progress."""
        self.tick()
        with self.storage.database.writing() as store:
            _unless_ended(Jobs(store).read_on(self.id, done // KILOBYTE, times))

    def keeping(self) -> None:
        """Marks the job as being stored: from now on it cannot be cancelled."""
        with self.storage.database.writing() as store:
            _unless_ended(Jobs(store).begin_storing(self.id))

    def stored(self, store: Store, receipt: Receipt) -> None:
        """Ends the job with the session."""
        _unless_ended(Jobs(store).take_in(self.id, receipt.id, self.now))

    def refused(self, store: Store, number: int) -> None:
        """Ends the job with the refusal."""
        _unless_ended(Jobs(store).refuse(self.id, number, self.now))


def _unless_ended(is_open: bool) -> None:
    if not is_open:
        raise EndedError("The job has ended already.")


def take_in(reception: Reception, id: int, now: datetime, tick: Callable[[], None] = lambda: None) -> None:
    """Reads, judges and stores the file of a job, or refuses it. A passing failure is raised, such as a full disk.

    ``tick`` is called repeatedly during the reading, and cancels it by raising.
    """
    with reception.storage.database.writing() as store:
        job = Jobs(store).begin(id, now)
    assert job.sent is not None
    if job.is_open:
        try:
            _taken_in(reception, job, job.sent, _JobHooks(reception.storage, id, now, tick))
        except EndedError:
            pass
        except FINAL as fault:
            give_up(reception.storage, id, fault.detail, now)
    drop_waiting(reception.storage.files, job.sent.place)


def give_up(storage: Storage, id: int, reason: str, now: datetime) -> None:
    """Ends the job of a file that cannot be processed, through no fault of its own."""
    with storage.database.writing() as store:
        job = Jobs(store).get(id)
        Jobs(store).fail(id, JobFailure(job.subject, reason), now)
    if job.sent is not None:
        drop_waiting(storage.files, job.sent.place)


def _taken_in(reception: Reception, job: Job, sent: Sent, job_hooks: _JobHooks) -> None:
    storage, received_at = reception.storage, job.asked_at
    acting = replace(storage, database=storage.database.acting(sent.account))
    hooks = UploadHooks(job_hooks.keeping, job_hooks.stored, job_hooks.refused)
    job_reception = replace(reception, storage=acting, who=job.who, course=hooks)
    file_on_disk = waiting_file(storage.files, sent.place, sent.sha256, sent.size)
    file = SentFile(job.subject, file_on_disk, **sent.stated())
    try:
        with reports_progress_to(job_hooks.read_on):
            mapped = None if file.mapping is None else receive_mapped(job_reception, file, file.mapping, received_at)
            receipt = mapped or receive(job_reception, file, received_at)
    except RefusedError as fault:
        if _is_open(storage, job.id):  # its mapping was refused before the file was read
            received = Received(sent.size, sent.sha256, job.subject, received_at, job.who)
            refuse(acting, received, fault.problems, hooks)
    else:
        with storage.database.writing() as store:  # no session was stored where it was there already
            Jobs(store).take_in(job.id, receipt.id, job_hooks.now)


def _is_open(storage: Storage, id: int) -> bool:
    with storage.database.reading() as store:
        return Jobs(store).get(id).is_open


def sweep_waiting(storage: Storage, now: datetime) -> None:
    """Removes files without a job."""
    with storage.database.reading() as store:
        places = Jobs(store).places()
    drop_orphaned(storage.files, places, now)
