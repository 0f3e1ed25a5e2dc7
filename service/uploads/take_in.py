"""Flow: a long file that was received whole → a job → stored or refused, as any upload, beside the requests.

The file waits on disk under a name of its own before its job is on record, and is removed after that has ended: a
service that is killed at any moment leaves a job that another one takes up, or a file that nobody waits for and that is
swept. The job ends in the transaction that stores the session or records the refusal, so each is there once.
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
from service.ingest.apart import heard_by
from service.ingest.checked import plain_filename
from service.jobs.changes import Course, require_room
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
from service.storage.waiting import drop_unasked, drop_waiting, put_waiting, waiting_file
from service.uploads.receive import receive, receive_mapped, refuse

FINAL = (NotFoundError, ConflictError, ForbiddenError, DamagedError)
"""What another try would end in too."""


def is_long(storage: Storage, file: SentFile, longer_than: int) -> bool:
    """Whether a file is one to be taken in by a job: larger, and not there already."""
    if len(file.content) <= longer_than:
        return False
    if file.replaces is not None or file.mapping is not None:
        return True
    with storage.database.reading() as store:
        return Sessions(store).by_hash(content_hash(file.content)) is None


class EndedError(ServiceError):
    """Somebody cancelled the job, or another process ended it: nothing more is done for it."""


def ask_upload(storage: Storage, file: SentFile, person: Person, place: str, now: datetime) -> Job:
    """Keeps a file under its ``place`` and what is to be done with it; the same file sent again is the same job."""
    if file.replaces is not None:
        with storage.database.reading() as store:
            Sessions(store).get(file.replaces.session)
    digest = content_hash(file.content)
    sent = Sent(place, digest, len(file.content), person.account, **file.stated())
    put_waiting(storage.files, place, file.content)
    new = NewJob(JobKind.UPLOAD, person.signs("crew"), person.login, subject=plain_filename(file.filename), sent=sent)
    try:
        with storage.database.writing() as store:
            known = next((job for job in Jobs(store).sending(digest) if _is_same(job, new)), None)
            job = _added(store, new, now) if known is None else known
    except BusyError:
        drop_waiting(storage.files, place)
        raise
    if known is not None:
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
class _Following:
    """A job at the steps of its upload."""

    storage: Storage
    id: int
    now: datetime
    tick: Callable[[], None]

    def read_on(self, done: int, times: int) -> None:
        """So many bytes were read."""
        self.tick()
        with self.storage.database.writing() as store:
            _unless_ended(Jobs(store).read_on(self.id, done // KILOBYTE, times))

    def keeping(self) -> None:
        """Nobody cancels it from now on."""
        with self.storage.database.writing() as store:
            _unless_ended(Jobs(store).begin_storing(self.id))

    def stored(self, store: Store, receipt: Receipt) -> None:
        """It ends with the session."""
        _unless_ended(Jobs(store).take_in(self.id, receipt.id, self.now))

    def refused(self, store: Store, number: int) -> None:
        """It ends with the refusal."""
        _unless_ended(Jobs(store).refuse(self.id, number, self.now))


def _unless_ended(is_open: bool) -> None:
    if not is_open:
        raise EndedError("The job has ended already.")


def take_in(reception: Reception, id: int, now: datetime, tick: Callable[[], None] = lambda: None) -> None:
    """Reads, judges and stores the file of a job, or refuses it. What passes is raised, as when the disk is full.

    ``tick`` is called now and then while it is read, and ends it by raising.
    """
    with reception.storage.database.writing() as store:
        job = Jobs(store).begin(id, now)
    assert job.sent is not None
    if job.is_open:
        try:
            _taken_in(reception, job, job.sent, _Following(reception.storage, id, now, tick))
        except EndedError:
            pass
        except FINAL as fault:
            give_up(reception.storage, id, fault.detail, now)
    drop_waiting(reception.storage.files, job.sent.place)


def give_up(storage: Storage, id: int, reason: str, now: datetime) -> None:
    """The file cannot be taken in, through no fault of its own."""
    with storage.database.writing() as store:
        job = Jobs(store).get(id)
        Jobs(store).fail(id, JobFailure(job.subject, reason), now)
    if job.sent is not None:
        drop_waiting(storage.files, job.sent.place)


def _taken_in(reception: Reception, job: Job, sent: Sent, at: _Following) -> None:
    storage, came = reception.storage, job.asked_at
    acting = replace(storage, database=storage.database.acting(sent.account))
    course = Course(at.keeping, at.stored, at.refused)
    own = replace(reception, storage=acting, who=job.who, course=course)
    landed = waiting_file(storage.files, sent.place, sent.sha256, sent.size)
    file = SentFile(job.subject, landed, **sent.stated())
    try:
        with heard_by(at.read_on):
            mapped = None if file.mapping is None else receive_mapped(own, file, file.mapping, came)
            receipt = mapped or receive(own, file, came)
    except RefusedError as fault:
        if _is_open(storage, job.id):  # its mapping was refused before the file was read
            received = Received(sent.size, sent.sha256, job.subject, came, job.who)
            refuse(acting, received, fault.problems, course)
    else:
        with storage.database.writing() as store:  # no session was stored where it was there already
            Jobs(store).take_in(job.id, receipt.id, at.now)


def _is_open(storage: Storage, id: int) -> bool:
    with storage.database.reading() as store:
        return Jobs(store).get(id).is_open


def sweep_waiting(storage: Storage, now: datetime) -> None:
    """Removes files that no job waits for."""
    with storage.database.reading() as store:
        places = Jobs(store).places()
    drop_unasked(storage.files, places, now)
