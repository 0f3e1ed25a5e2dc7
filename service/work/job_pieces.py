"""One piece of long work: a unit computed again, or a report. What is whole is kept, and counted with it at once."""

from datetime import datetime

from service.jobs.records import KEPT, Job, JobFailure, JobKind, Made, Piece
from service.jobs.store import Jobs
from service.jobs.words import AT_FAULT, left_in_words
from service.kit.failure_words import with_last_try
from service.languages.language import Language
from service.papers.fleet.file import fleet_file
from service.records.recalibrate import Recalibrated, recalibrate
from service.storage import Storage
from service.storage.made import drop_made, put_made
from service.storage.store import Store


def work_piece(storage: Storage, id: int, now: datetime, coverage_factor: float) -> None:
    """Does the next piece of a job, unless it has ended."""
    with storage.database.writing() as store:
        job = Jobs(store).begin(id, now)
    if not job.is_open:
        return
    if job.kind is JobKind.REPORT:
        _report(storage, job, now)
    else:
        _recalibrate_next(storage, job, now, coverage_factor)


def skip_piece(storage: Storage, id: int, now: datetime) -> None:
    """The program failed at it, or no process outlived it: it is listed, and the next one follows."""
    with storage.database.writing() as store:
        job = Jobs(store).get(id)
        reason = with_last_try(AT_FAULT, job.held_up)
        unit = Jobs(store).next_unit(job) if job.kind is JobKind.RECALIBRATION else None
        if unit is None:
            Jobs(store).fail(id, JobFailure(job.subject, reason), now)
        else:
            Jobs(store).advance(job, unit[0], Piece(failure=JobFailure(unit[1], reason)), now)


def _report(storage: Storage, job: Job, now: datetime) -> None:
    with storage.database.reading() as store:
        content = fleet_file(store, job.form, now, Language(job.language))
    digest = put_made(storage.files, job.id, content)
    made = Made(f"fleet-{now:%Y-%m-%d}.{job.form}", len(content), digest, now + KEPT)
    with storage.database.writing() as store:
        kept = Jobs(store).finish(job.id, made, now)
    if not kept:
        drop_made(storage.files, job.id)


def _recalibrate_next(storage: Storage, job: Job, now: datetime, coverage_factor: float) -> None:
    with storage.database.reading() as store:
        unit = Jobs(store).next_unit(job)
    if unit is None:
        with storage.database.writing() as store:
            Jobs(store).finish(job.id, None, now)
        return

    def count(store: Store, done: Recalibrated) -> None:
        failure = JobFailure(done.unit, left_in_words(done.left)) if done.left else None
        Jobs(store).advance(job, unit[0], Piece(done.recomputed, len(done.verdicts), failure), now)

    recalibrate(storage, unit[1], now, coverage_factor=coverage_factor, who=job.who, then=count)
