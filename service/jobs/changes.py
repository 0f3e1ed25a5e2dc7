"""Requests, progress and cancellation of long jobs."""

from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime

from estimator.errors import problem_at
from estimator.message import say
from service.errors import BusyError, ConflictError, ForbiddenError, RefusedError
from service.jobs.records import Job, JobKind, NewJob
from service.jobs.store import Failures, Jobs
from service.kit.person import Person, Role
from service.models.records import ModelRevision
from service.models.store import Recomputations
from service.sessions.records import Receipt
from service.storage import Storage
from service.storage.audit import Audit
from service.storage.files import Files
from service.storage.made import drop_made, read_made
from service.storage.queries import Store
from service.storage.waiting import drop_waiting

MOST_OPEN = 100
"""Jobs that are waiting or running: more than a crew requests in a day."""
STORING = "The file is read and is being stored. Withdraw its session instead, once it is there."


def ask_job(storage: Storage, new: NewJob, now: datetime) -> Job:
    """Creates a job, or returns the open job for the same work.

    RefusedError where no unit is concerned, BusyError where too many jobs wait.
    """
    with storage.database.writing() as store:
        known = Jobs(store).like(new)
        if known is not None:
            return known
        require_room(store)
        job = Jobs(store).add(new, _pieces(store, new), now)
        details = {"job": job.id, "scope": new.scope or "fleet", "form": new.form}
        Audit(store).write(now, new.who, new.kind.value, new.subject or "fleet", details)
        return job


def require_room(store: Store) -> None:
    """BusyError where too many jobs wait."""
    if Jobs(store).open_count() >= MOST_OPEN:
        raise BusyError("{most_open} jobs wait already. Cancel one, or ask again later.", most_open=MOST_OPEN)


def add_model_job(store: Store, changed: ModelRevision, units: int, now: datetime) -> None:
    """Adds a job for the recomputation of units under a changed model."""
    if units:
        new = NewJob(
            JobKind.MODEL, changed.accepted_by, scope=changed.scope, subject=changed.subject, revision=changed.id
        )
        Jobs(store).add(new, units, now)


def _pieces(store: Store, new: NewJob) -> int:
    if new.kind is JobKind.REPORT:
        return 1
    units = Jobs(store).units(new.scope, new.subject)
    if new.scope is not None and not units:
        raise RefusedError(
            "There is nothing to compute again.",
            (problem_at("subject", "no unit is {subject}'s", subject=repr(new.subject)),),
        )
    return units


def may_cancel(job: Job, person: Person) -> bool:
    """Whether a person may cancel a job: its requester and engineers may."""
    return person.may(Role.ENGINEER) or bool(job.account and job.account == person.login)


def cancel_job(storage: Storage, id: int, person: Person, who: str, now: datetime) -> Job:
    """Stops it between two pieces: finished pieces stay. ConflictError where it has ended."""
    with storage.database.writing() as store:
        job = Jobs(store).get(id)
        if not may_cancel(job, person):
            raise ForbiddenError("Only whoever asked for a job, or an engineer, cancels it.")
        if not Jobs(store).cancel(id, who, now):
            raise ConflictError(
                STORING if job.is_open else say("Job {id} has ended already: it is {state}.", id=id, state=job.state)
            )
        if job.kind is JobKind.MODEL:
            Recomputations(store).cancel(job.revision, now)
        Audit(store).write(now, who, "cancel job", job.subject or "fleet", {"job": id, "done": job.done})
        cancelled = Jobs(store).get(id)
    if job.sent is not None:
        drop_waiting(storage.files, job.sent.place)
    return cancelled


def file_of(files: Files, job: Job) -> bytes:
    """The file made by a job; ConflictError where there is none any more."""
    if job.made is None:
        raise ConflictError(
            "Job {id} has no file to give out: it is {state}, or its time is over.", id=job.id, state=job.state
        )
    return read_made(files, job.id, job.made.sha256)


def drop_expired(storage: Storage, now: datetime) -> None:
    """Removes files of jobs whose retention time is over."""
    with storage.database.reading() as store:
        expired = Jobs(store).outlived(now)
    for id in expired:
        drop_made(storage.files, id)
        with storage.database.writing() as store:
            Jobs(store).forget_file(id)


def retry_failed(storage: Storage, now: datetime, who: str) -> int:
    """Retries everything that failed and is still wanted; returns the number of pieces."""
    with storage.database.writing() as store:
        count = Failures(store).try_again() + Failures(store).request_given_up(now)
        Audit(store).write(now, who, "retry", "failed work", {"pieces": count})
    return count


def _no_op(*_: object) -> None:
    """No-op."""


@dataclass(frozen=True)
class UploadHooks:
    """Hooks of one upload. An exception raised by a hook stops it, and nothing is stored."""

    keeping: Callable[[], None] = _no_op
    """Called before its bytes are stored, when its readings are valid."""
    stored: Callable[[Store, Receipt], None] = _no_op
    """Called within the transaction that stores it."""
    refused: Callable[[Store, int], None] = _no_op
    """Called within the transaction that records the refusal, with its number."""


NO_HOOKS = UploadHooks()
"""Hooks of an upload whose sender waits for the answer."""
