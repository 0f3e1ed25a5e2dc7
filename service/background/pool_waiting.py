"""Work beside the requests: what groups of sessions show, each made by one process at a time."""

from collections.abc import Callable
from datetime import datetime, timedelta
from threading import Event

from service.background.diagnose_waiting import Diagnosing
from service.background.guard import Alone, plainly
from service.background.helper import LONGEST, DiedError, Failure, Helper, StoppingError
from service.flows.refresh_group import current
from service.log import log
from service.records.group import Group
from service.storage import Storage

CLAIM = timedelta(seconds=LONGEST)
"""That a claim holds: no process is at one longer. What fails is tried again after it."""
WORK = "pending groups"
"""As the log and the figures name it."""


def pool_next(own: Diagnosing, helper: Helper, stop: Event) -> bool:
    """Makes the answer of the group that is next; whether there was one."""
    group = _claimed(own)
    if group is None:
        return False
    try:
        failure = helper.pool(group, own.clock(), lambda: not stop.is_set())
    except DiedError as died:
        failure = Failure(type(died).__name__, str(died))
    except StoppingError:
        failure = None
        _give_back(own, group)
    if failure is not None:
        log.warning("group pending", level=group.level.value, name=group.name, reason=failure.reason)
        own.metrics.count_fault(WORK, failure.fault)
    own.bell.ring()
    return True


def _claimed(own: Diagnosing) -> Group | None:
    now = own.clock()
    with own.storage.database.reading() as store:
        waiting = store.pending_groups.waiting(now, 1 + own.settings.diagnosis_workers)
    for group in waiting:
        with own.storage.database.writing() as store:
            if store.pending_groups.claim(group, now, now + CLAIM):
                return group
    return None


def _give_back(own: Diagnosing, group: Group) -> None:
    with own.storage.database.writing() as store:
        store.pending_groups.give_back(group)


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
