"""The kinds of background work: how each is done, how often it is attempted, and what happens when it is given up."""

from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime, timedelta

from service.fleet.changes import summarise
from service.groups.records import Group
from service.groups.store import Groups
from service.jobs.records import KEPT, Job, JobFailure, JobKind, Made, RecalibrationPiece
from service.jobs.store import Jobs
from service.jobs.words import AT_FAULT, FILE_AT_FAULT, left_in_words
from service.kit.failure import with_last_try
from service.languages.language import Language
from service.models.records import task_of
from service.models.store import Recomputations
from service.papers.fleet.paper import fleet_pdf
from service.papers.fleet.report import fleet_report
from service.papers.fleet.workbook import fleet_xlsx
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.records import diagnose, refresh_group
from service.records.follow import refresh_beside
from service.records.recalibrate import Recalibrated, recalibrate, recompute
from service.storage import Storage
from service.storage.made import drop_made, put_made
from service.storage.queries import Store
from service.uploads.take_in import give_up

PUT_OFF = timedelta(minutes=10)
"""Delay after an attempt that a passing cause prevented, such as a lost file; a reader of a diagnosis retries at once.
"""
MOST_ATTEMPTS = 3
"""Attempts at which the program may fail, or its process die, before work is given up: two could be a machine in
trouble."""
MOST_ATTEMPTS_OF_FILE = 10
"""Attempts at a file, which is read for minutes: it survives some restarts, and an acknowledged upload is not lost by
them.
"""
PUT_OFF_FILE = timedelta(minutes=1)
"""Delay after an attempt that a passing cause prevented: somebody waits for the verdict."""
LEASE = timedelta(seconds=30)
"""Time after which the work of a dead service is started again."""


@dataclass(frozen=True)
class Kind:
    """One kind of background work."""

    name: str
    """Name in the log and the metrics."""
    kind: WorkKind
    make: Callable[[Storage, str, datetime, float], object] | None
    """Done in a separate process, from its key, the time and the coverage factor; None for what the service does
    itself."""
    give_up: Callable[[Storage, str, datetime], None] | None = None
    """Records that the program failed, or its process died, every time; None where the queue records it."""
    most: int = MOST_ATTEMPTS
    put_off: timedelta = PUT_OFF

    def queue(self, store: Store) -> WorkQueue:
        """The queue of this kind of work."""
        return WorkQueue(store, self.kind)

    def end(self, storage: Storage, key: str, now: datetime) -> None:
        """Gives a piece up."""
        if self.give_up is not None:
            self.give_up(storage, key, now)
            return
        with storage.database.writing() as store:
            self.queue(store).give_up(key)


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
    """Lists a piece at which the program failed, or its process died, every time; the next one follows."""
    with storage.database.writing() as store:
        job = Jobs(store).get(id)
        reason = with_last_try(AT_FAULT, job.held_up)
        unit = Jobs(store).next_unit(job) if job.kind is JobKind.RECALIBRATION else None
        if unit is None:
            Jobs(store).fail(id, JobFailure(job.subject, reason), now)
        else:
            Jobs(store).advance(job, unit[0], RecalibrationPiece(failure=JobFailure(unit[1], reason)), now)


def _report(storage: Storage, job: Job, now: datetime) -> None:
    with storage.database.reading() as store:
        make = fleet_xlsx if job.form == "xlsx" else fleet_pdf
        content = make(store, fleet_report(store, now), Language(job.language))
    digest = put_made(storage.files, job.id, content)
    made = Made(f"fleet-{now:%Y-%m-%d}.{job.form}", len(content), digest, now + KEPT)
    with storage.database.writing() as store:
        is_open = Jobs(store).finish(job.id, made, now)
    if not is_open:
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
        Jobs(store).advance(job, unit[0], RecalibrationPiece(done.recomputed, len(done.verdicts), failure), now)

    recalibrate(storage, unit[1], now, coverage_factor=coverage_factor, who=job.who, record=count)


def _make_group(storage: Storage, place: str, now: datetime, _: float) -> None:
    refresh_group.refresh_group(storage, _group(storage, place), now)


def _give_up_group(storage: Storage, place: str, now: datetime) -> None:
    refresh_group.give_up(storage, _group(storage, place), now)


def _group(storage: Storage, place: str) -> Group:
    with storage.database.reading() as store:
        return Groups(store).at(place)


def _give_up_model(storage: Storage, key: str, now: datetime) -> None:
    task = task_of(key)
    with storage.database.writing() as store:
        Recomputations(store).give_up(task, now)
        Jobs(store).count_unit(task.revision, RecalibrationPiece(failure=JobFailure(task.unit, AT_FAULT)), now)


DIAGNOSES = Kind("pending diagnoses", WorkKind.DIAGNOSIS, diagnose.diagnose, diagnose.give_up)
OUTLOOKS = Kind(
    "pending outlooks", WorkKind.OUTLOOK, lambda storage, serial, now, _: refresh_beside(storage, serial, now)
)
MODELS = Kind(
    "pending models",
    WorkKind.RECOMPUTATION,
    lambda storage, key, now, k: recompute(storage, task_of(key), now, k),
    _give_up_model,
)
JOBS = Kind(
    "jobs",
    WorkKind.JOB,
    lambda storage, id, now, k: work_piece(storage, int(id), now, k),
    lambda storage, id, now: skip_piece(storage, int(id), now),
)
SUMMARIES = Kind("pending summaries", WorkKind.SUMMARY, lambda storage, place, now, _: summarise(storage, place, now))
"""Given up, the previous summary stays until a record of the group changes."""
GROUPS = Kind("pending groups", WorkKind.GROUP, _make_group, _give_up_group, most=MOST_ATTEMPTS + 1)
"""One attempt more than others: a session whose statistics no process survives is given up at its fourth attempt, which
is the group's fourth too, and the group goes on without it."""
UPLOADS = Kind(
    "uploads",
    WorkKind.UPLOAD,
    None,
    lambda storage, id, now: give_up(storage, int(id), FILE_AT_FAULT, now),
    most=MOST_ATTEMPTS_OF_FILE,
    put_off=PUT_OFF_FILE,
)
KINDS = {kind.kind: kind for kind in (OUTLOOKS, MODELS, JOBS, DIAGNOSES, SUMMARIES, GROUPS)}
"""Kinds that one process does, in the order of `Rank`."""
