"""Flow: long work is asked for, to be done beside the requests, and cancelled again."""

from datetime import datetime

from estimator.errors import Problem
from service.errors import BusyError, ConflictError, ForbiddenError, RefusedError
from service.records.identity import Person, Role
from service.records.job import Job, JobKind, NewJob
from service.records.model import ModelRevision
from service.storage import Storage
from service.storage.files import Files
from service.storage.made import drop_made, read_made
from service.storage.store import Store
from service.storage.waiting import drop_waiting

MOST_OPEN = 100
"""Jobs that wait or are at work: more than a crew asks for in a day."""
STORING = "The file is read and is being stored. Withdraw its session instead, once it is there."
REPORTS = ("xlsx", "pdf")
"""Forms of a report that takes long."""


def ask_job(storage: Storage, new: NewJob, now: datetime) -> Job:
    """Keeps what is asked for; where the same is still to be done it is that job.

    RefusedError where no unit is meant, BusyError where too many jobs wait already.
    """
    with storage.database.writing() as store:
        known = store.jobs.like(new)
        if known is not None:
            return known
        require_room(store)
        job = store.jobs.add(new, _pieces(store, new), now)
        details = {"job": job.id, "scope": new.scope or "fleet", "form": new.form}
        store.audit.write(now, new.who, new.kind.value, new.subject or "fleet", details)
        return job


def require_room(store: Store) -> None:
    """BusyError where too many jobs wait already."""
    if store.jobs.open_count() >= MOST_OPEN:
        raise BusyError(f"{MOST_OPEN} jobs wait already. Cancel one, or ask again later.")


def tell_job(store: Store, changed: ModelRevision, units: int, now: datetime) -> None:
    """Keeps as a job that the units of a changed model are computed again."""
    if units:
        own = NewJob(
            JobKind.MODEL, changed.accepted_by, scope=changed.scope, subject=changed.subject, revision=changed.id
        )
        store.jobs.add(own, units, now)


def _pieces(store: Store, new: NewJob) -> int:
    """How many pieces it has."""
    if new.kind is JobKind.REPORT:
        return 1
    units = store.jobs.units(new.scope, new.subject)
    if new.scope is not None and not units:
        raise RefusedError("There is nothing to compute again.", (Problem("subject", f"no unit is {new.subject!r}'s"),))
    return units


def may_cancel(job: Job, person: Person) -> bool:
    """Whoever asked for it, and engineers."""
    return person.may(Role.ENGINEER) or bool(job.account and job.account == person.login)


def cancel_job(storage: Storage, id: int, person: Person, who: str, now: datetime) -> Job:
    """Stops it between two pieces: what is whole stays. ConflictError where it has ended."""
    with storage.database.writing() as store:
        job = store.jobs.get(id)
        if not may_cancel(job, person):
            raise ForbiddenError("Only whoever asked for a job, or an engineer, cancels it.")
        if not store.jobs.cancel(id, who, now):
            raise ConflictError(STORING if job.is_open else f"Job {id} has ended already: it is {job.state}.")
        if job.kind is JobKind.MODEL:
            store.recomputations.cancel(job.revision, now)
        store.audit.write(now, who, "cancel job", job.subject or "fleet", {"job": id, "done": job.done})
        cancelled = store.jobs.get(id)
    if job.sent is not None:
        drop_waiting(storage.files, job.sent)
    return cancelled


def file_of(files: Files, job: Job) -> bytes:
    """What a job made; ConflictError where it made none or keeps it no longer."""
    if job.made is None:
        raise ConflictError(f"Job {job.id} has no file to give out: it is {job.state}, or its time is over.")
    return read_made(files, job.id, job.made.sha256)


def drop_outlived(storage: Storage, now: datetime) -> None:
    """Removes the files of jobs that were kept for their time."""
    with storage.database.reading() as store:
        outlived = store.jobs.outlived(now)
    for id in outlived:
        drop_made(storage.files, id)
        with storage.database.writing() as store:
            store.jobs.forget_file(id)
