"""Work beside the requests: sessions that a group's finding in their model changes, unit by unit."""

from datetime import datetime
from threading import Event

from service.background.claimed import Work, work_next
from service.background.diagnose_waiting import Diagnosing
from service.background.helper import Helper
from service.records.job import JobFailure, Piece
from service.records.recomputation import Task
from service.storage import Storage
from service.words.jobs import AT_FAULT


def _give_up(storage: Storage, task: Task, now: datetime) -> None:
    with storage.database.writing() as store:
        store.recomputations.give_up(task, now)
        store.jobs.count_unit(task.revision, Piece(failure=JobFailure(task.unit, AT_FAULT)), now)


MODELS = Work("pending models", queue=lambda store: store.recomputations, make=Helper.recompute, give_up=_give_up)


def recompute_next(own: Diagnosing, helper: Helper, stop: Event) -> bool:
    """Computes the sessions of the unit that is next; whether there was one."""
    return work_next(own, helper, stop, MODELS)
