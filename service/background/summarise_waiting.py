"""Work beside the requests: how the units of types drift and how stands stand, each made by one process at a time."""

from datetime import datetime
from threading import Event

from service.background.claimed import Work, work_next
from service.background.diagnose_waiting import Diagnosing
from service.background.helper import Helper
from service.records.group import Group
from service.storage import Storage


def _give_up(storage: Storage, group: Group, now: datetime) -> None:
    """What was made last stays, until a record of the group changes again."""
    with storage.database.writing() as store:
        store.pending_summaries.give_up(group)


SUMMARIES = Work(
    "pending summaries", queue=lambda store: store.pending_summaries, make=Helper.summarise, give_up=_give_up
)


def summarise_next(own: Diagnosing, helper: Helper, stop: Event) -> bool:
    """Makes the summary that is next; whether there was one."""
    return work_next(own, helper, stop, SUMMARIES)
