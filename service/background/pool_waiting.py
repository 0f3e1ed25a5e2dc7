"""Work beside the requests: what groups of sessions show, each made by one process at a time."""

from collections.abc import Callable
from datetime import datetime
from threading import Event

from service.background.claimed import Work, work_next
from service.background.diagnose_waiting import MOST_ATTEMPTS, Diagnosing
from service.background.helper import Helper
from service.flows.guard import Alone, plainly
from service.flows.refresh_group import current, give_up
from service.storage import Storage

GROUPS = Work(
    "pending groups",
    queue=lambda store: store.pending_groups,
    make=Helper.pool,
    give_up=give_up,
    most=MOST_ATTEMPTS + 1,
)
"""One try more than others: a session of which no process outlives the statistics is given up at its fourth try, which
is the group's fourth too, and the group goes on without it."""


def pool_next(own: Diagnosing, helper: Helper, stop: Event) -> bool:
    """Makes the answer of the group that is next; whether there was one."""
    return work_next(own, helper, stop, GROUPS)


def ask_for_outdated(storage: Storage, clock: Callable[[], datetime], alone: Alone = plainly) -> int:
    """Asks for every group whose answer does not rest on its sessions of now, as after an update; returns how many."""
    with storage.database.reading() as store:
        groups = store.groups.every()
    count = 0
    for group in groups:
        with alone("groups", group.name):
            with storage.database.reading() as store:
                is_wanted = current(store, group) is None and not store.pending_groups.asked(group)
            if is_wanted:
                count += 1
                with storage.database.writing() as store:
                    store.pending_groups.ask((group,), clock())
    return count
