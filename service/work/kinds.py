"""The kinds of work beside the requests: how each is made, how often it is tried, and what it does when given up."""

from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Any, Generic, Protocol, TypeVar

from service.fleet.changes import summarise
from service.groups.records import Group
from service.groups.store import Groups
from service.jobs.records import JobFailure, Piece
from service.jobs.store import Jobs
from service.jobs.words import AT_FAULT
from service.models.records import Task
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
T = TypeVar("T")
"""What stands in a queue."""


class Queue(Protocol[T]):
    """What is asked for."""

    def waiting(self, now: datetime, limit: int) -> tuple[T, ...]:
        """What nobody is at, the first before all."""

    def claim(self, one: T, now: datetime, until: datetime, /) -> int | None:
        """How often it was begun since a try ended with an answer; None where another is at it."""

    def extend(self, one: T, until: datetime, /) -> None:
        """Whoever claimed it is still at it."""

    def hold_up(self, one: T, why: str, /) -> None:
        """Keeps why a try failed."""

    def give_back(self, one: T, /) -> None:
        """The program failed or its process died: the next one may take it at once."""

    def put_off(self, one: T, until: datetime | None, /) -> None:
        """Ends a lease after a try that says why: nobody begins it before a time."""


@dataclass(frozen=True)
class Kind(Generic[T]):
    """One kind of it."""

    name: str
    """As the log and the figures name it."""
    kind: WorkKind
    queue: Callable[[Store], Queue[T]]
    make: Callable[[Storage, T, datetime, float], object] | None
    """In a process of its own, with the time and the coverage factor; None for what the service does itself."""
    give_up: Callable[[Storage, T, datetime], None]
    """Keeps that the program failed at it, or that no process outlived it."""
    most: int = MOST_ATTEMPTS
    put_off: timedelta = PUT_OFF
    is_awaited: bool = False
    """Somebody may wait for one, which then comes before the others."""


def _make_group(storage: Storage, place: str, now: datetime, _: float) -> None:
    refresh_group.refresh_group(storage, _group(storage, place), now)


def _give_up_group(storage: Storage, place: str, now: datetime) -> None:
    refresh_group.give_up(storage, _group(storage, place), now)


def _group(storage: Storage, place: str) -> Group:
    with storage.database.reading() as store:
        return Groups(store).at(place)


def _give_up_outlook(storage: Storage, serial: str, _: datetime) -> None:
    with storage.database.writing() as store:
        WorkQueue(store, WorkKind.OUTLOOK).give_up(serial)


def _give_up_summary(storage: Storage, place: str, _: datetime) -> None:
    """What was made last stays, until a record of the group changes again."""
    with storage.database.writing() as store:
        WorkQueue(store, WorkKind.SUMMARY).give_up(place)


def _give_up_model(storage: Storage, task: Task, now: datetime) -> None:
    with storage.database.writing() as store:
        Recomputations(store).give_up(task, now)
        Jobs(store).count_unit(task.revision, Piece(failure=JobFailure(task.unit, AT_FAULT)), now)


DIAGNOSES: Kind[str] = Kind(
    "pending diagnoses",
    WorkKind.DIAGNOSIS,
    lambda store: WorkQueue(store, WorkKind.DIAGNOSIS),
    diagnose.diagnose,
    diagnose.give_up,
    is_awaited=True,
)
OUTLOOKS: Kind[str] = Kind(
    "pending outlooks",
    WorkKind.OUTLOOK,
    lambda store: WorkQueue(store, WorkKind.OUTLOOK),
    lambda storage, serial, now, _: refresh_beside(storage, serial, now),
    _give_up_outlook,
)
MODELS: Kind[Task] = Kind(
    "pending models", WorkKind.RECOMPUTATION, lambda store: Recomputations(store), recompute, _give_up_model
)
JOBS: Kind[int] = Kind("jobs", WorkKind.JOB, lambda store: Jobs(store), work_piece, skip_piece)
SUMMARIES: Kind[str] = Kind(
    "pending summaries",
    WorkKind.SUMMARY,
    lambda store: WorkQueue(store, WorkKind.SUMMARY),
    lambda storage, place, now, _: summarise(storage, place, now),
    _give_up_summary,
)
GROUPS: Kind[str] = Kind(
    "pending groups",
    WorkKind.GROUP,
    lambda store: WorkQueue(store, WorkKind.GROUP),
    _make_group,
    _give_up_group,
    most=MOST_ATTEMPTS + 1,
)
"""One try more than others: a session of which no process outlives the statistics is given up at its fourth try, which
is the group's fourth too, and the group goes on without it."""
IN_TURN: tuple[Kind[Any], ...] = (OUTLOOKS, MODELS, JOBS, DIAGNOSES)
"""One of each in turn, so that none waits for all of the others."""
AT_LAST: tuple[Kind[Any], ...] = (SUMMARIES, GROUPS)
"""While nothing else waits: summaries rest on all outlooks, and every diagnosis changes what a group rests on."""
KINDS = {kind.kind: kind for kind in (*IN_TURN, *AT_LAST)}
