"""Long work is asked for, followed and cancelled."""

from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime

from estimator.errors import Problem
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
"""Jobs that wait or are at work: more than a crew asks for in a day."""
STORING = "The file is read and is being stored. Withdraw its session instead, once it is there."
REPORTS = ("xlsx", "pdf")
"""Forms of a report that takes long."""


def ask_job(storage: Storage, new: NewJob, now: datetime) -> Job:
    """Keeps what is asked for; where the same is still to be done it is that job.

    RefusedError where no unit is meant, BusyError where too many jobs wait already.
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
    """BusyError where too many jobs wait already."""
    if Jobs(store).open_count() >= MOST_OPEN:
        raise BusyError(say("{most_open} jobs wait already. Cancel one, or ask again later.", most_open=MOST_OPEN))


def tell_job(store: Store, changed: ModelRevision, units: int, now: datetime) -> None:
    """Keeps as a job that the units of a changed model are computed again."""
    if units:
        own = NewJob(
            JobKind.MODEL, changed.accepted_by, scope=changed.scope, subject=changed.subject, revision=changed.id
        )
        Jobs(store).add(own, units, now)


def _pieces(store: Store, new: NewJob) -> int:
    """How many pieces it has."""
    if new.kind is JobKind.REPORT:
        return 1
    units = Jobs(store).units(new.scope, new.subject)
    if new.scope is not None and not units:
        raise RefusedError(
            "There is nothing to compute again.",
            (Problem("subject", say("no unit is {subject}'s", subject=repr(new.subject))),),
        )
    return units


def may_cancel(job: Job, person: Person) -> bool:
    """Whoever asked for it, and engineers."""
    return person.may(Role.ENGINEER) or bool(job.account and job.account == person.login)


def cancel_job(storage: Storage, id: int, person: Person, who: str, now: datetime) -> Job:
    """Stops it between two pieces: what is whole stays. ConflictError where it has ended."""
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
    """What a job made; ConflictError where it made none or keeps it no longer."""
    if job.made is None:
        raise ConflictError(
            say("Job {id} has no file to give out: it is {state}, or its time is over.", id=job.id, state=job.state)
        )
    return read_made(files, job.id, job.made.sha256)


def drop_outlived(storage: Storage, now: datetime) -> None:
    """Removes the files of jobs that were kept for their time."""
    with storage.database.reading() as store:
        outlived = Jobs(store).outlived(now)
    for id in outlived:
        drop_made(storage.files, id)
        with storage.database.writing() as store:
            Jobs(store).forget_file(id)


def retry_failed(storage: Storage, now: datetime, who: str) -> int:
    """Everything that failed and that is still wanted; returns how much that is."""
    with storage.database.writing() as store:
        count = Failures(store).try_again() + Failures(store).ask_anew(now)
        Audit(store).write(now, who, "retry", "failed work", {"pieces": count})
    return count


def _nothing(*_: object) -> None:
    """Nobody follows it."""


@dataclass(frozen=True)
class Course:
    """Of one upload. Whatever raises here stops it, and nothing of it is stored."""

    keeping: Callable[[], None] = _nothing
    """Its readings are good, and its bytes are kept next."""
    stored: Callable[[Store, Receipt], None] = _nothing
    """Within the transaction that stores."""
    refused: Callable[[Store, int], None] = _nothing
    """Within the transaction that records the refusal, with its number."""


UNFOLLOWED = Course()
"""Whoever sent it waits for the answer."""
