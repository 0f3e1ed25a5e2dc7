"""Flow: a unit's sessions computed again under a model that a group's finding changed, and what that moved kept."""

from datetime import datetime

from service.flows.recalibrate import Recalibrated, recalibrate
from service.flows.receive import Reception
from service.records.job import JobFailure, Piece
from service.records.recomputation import Recomputed, Task
from service.storage import Storage
from service.storage.store import Store
from service.words.jobs import left_in_words


def recompute_beside(reception: Reception, now: datetime) -> None:
    """Wakes whoever works beside the requests; where nobody does, it is done at once."""
    reception.ring()
    while not reception.is_dated_later:
        with reception.storage.database.reading() as store:
            waiting = store.recomputations.waiting(now, 1)
        if not waiting:
            return
        recompute(reception.storage, waiting[0], now, reception.coverage_factor)


def recompute(storage: Storage, task: Task, now: datetime, coverage_factor: float) -> None:
    """Nothing is overwritten: earlier results stay readable under their revision."""

    def settle(store: Store, done: Recalibrated) -> None:
        outcome = Recomputed(done.sessions, done.recomputed, done.left, done.verdicts, done.furthest)
        if store.recomputations.settle(task, outcome, now):
            left = JobFailure(task.unit, left_in_words(done.left)) if done.left else None
            store.jobs.count_unit(task.revision, Piece(done.recomputed, len(done.verdicts), left), now)

    with storage.database.reading() as store:
        who = store.models.get(task.revision).accepted_by
    recalibrate(storage, task.unit, now, coverage_factor=coverage_factor, who=who, until=task.revision, then=settle)
