"""The kinds of work beside the requests: how each is made, how often it is tried, and what it does when given up."""

from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime, timedelta

from service.fleet.changes import summarise
from service.groups.records import Group
from service.groups.store import Groups
from service.jobs.records import JobFailure, Piece
from service.jobs.store import Jobs
from service.jobs.words import AT_FAULT
from service.models.records import task_of
from service.models.store import Recomputations
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.records import diagnose, refresh_group
from service.records.recalibrate import recompute
from service.records.refresh_outlooks import refresh_beside
from service.storage import Storage
from service.storage.store import Store
from service.work.job_pieces import skip_piece, work_piece

PUT_OFF = timedelta(minutes=10)
"""After a try that something passing hindered, as on a file that is lost; whoever reads a diagnosis tries at once."""
MOST_ATTEMPTS = 3
"""Tries at which the program may fail, or its process die, before work is given up: two could be a machine in need."""
LEASE = timedelta(seconds=30)
"""What a dead service was at is begun anew after it."""


@dataclass(frozen=True)
class Kind:
    """One kind of it."""

    name: str
    """As the log and the figures name it."""
    kind: WorkKind
    make: Callable[[Storage, str, datetime, float], object] | None
    """In a process of its own, by its key, with the time and the coverage factor; None for what the service does
    itself."""
    give_up: Callable[[Storage, str, datetime], None] | None = None
    """Keeps that the program failed at it, or that no process outlived it; None where the queue keeps it."""
    most: int = MOST_ATTEMPTS
    put_off: timedelta = PUT_OFF
    is_awaited: bool = False
    """Somebody may wait for one, which then comes before the others."""

    def queue(self, store: Store) -> WorkQueue:
        """Where it waits."""
        return WorkQueue(store, self.kind)

    def end(self, storage: Storage, key: str, now: datetime) -> None:
        """Gives a piece up."""
        if self.give_up is not None:
            self.give_up(storage, key, now)
            return
        with storage.database.writing() as store:
            self.queue(store).give_up(key)


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
        Jobs(store).count_unit(task.revision, Piece(failure=JobFailure(task.unit, AT_FAULT)), now)


DIAGNOSES = Kind("pending diagnoses", WorkKind.DIAGNOSIS, diagnose.diagnose, diagnose.give_up, is_awaited=True)
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
"""Given up, what was made last stays until a record of the group changes again."""
GROUPS = Kind("pending groups", WorkKind.GROUP, _make_group, _give_up_group, most=MOST_ATTEMPTS + 1)
"""One try more than others: a session of which no process outlives the statistics is given up at its fourth try, which
is the group's fourth too, and the group goes on without it."""
IN_TURN: tuple[Kind, ...] = (OUTLOOKS, MODELS, JOBS, DIAGNOSES)
"""One of each in turn, so that none waits for all of the others."""
AT_LAST: tuple[Kind, ...] = (SUMMARIES, GROUPS)
"""While nothing else waits: summaries rest on all outlooks, and every diagnosis changes what a group rests on."""
KINDS = {kind.kind: kind for kind in (*IN_TURN, *AT_LAST)}
