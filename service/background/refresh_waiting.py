"""Work beside the requests: outlooks of units whose history has changed, each made by one process at a time."""

from datetime import datetime
from threading import Event

from service.background.claimed import Work, work_next
from service.background.diagnose_waiting import Diagnosing
from service.background.helper import Helper
from service.storage import Storage


def _give_up(storage: Storage, serial: str, now: datetime) -> None:
    with storage.database.writing() as store:
        store.pending_outlooks.give_up(serial)


OUTLOOKS = Work("pending outlooks", queue=lambda store: store.pending_outlooks, make=Helper.refresh, give_up=_give_up)


def refresh_next(own: Diagnosing, helper: Helper, stop: Event) -> bool:
    """Works out the outlook that is next; whether there was one."""
    return work_next(own, helper, stop, OUTLOOKS)
