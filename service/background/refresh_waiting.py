"""Work beside the requests: outlooks of units whose history has changed, each made by one process at a time."""

from threading import Event

from service.background.diagnose_waiting import CLAIM, Diagnosing
from service.background.helper import DiedError, Failure, Helper, StoppingError
from service.log import log

WORK = "pending outlooks"
"""As the log and the figures name it."""


def refresh_next(own: Diagnosing, helper: Helper, stop: Event) -> bool:
    """Works out the outlook that is next; whether there was one. What fails is tried again when its claim runs out."""
    serial = _claimed(own)
    if serial is None:
        return False
    try:
        failure = helper.refresh(serial, own.clock(), lambda: not stop.is_set())
    except DiedError as died:
        failure = Failure(type(died).__name__, str(died))
    except StoppingError:
        failure = None
    if failure is not None:
        log.warning("outlook pending", unit=serial, reason=failure.reason)
        own.metrics.count_fault(WORK, failure.fault)
    own.bell.ring()
    return True


def _claimed(own: Diagnosing) -> str | None:
    now = own.clock()
    with own.storage.database.reading() as store:
        waiting = store.pending_outlooks.waiting(now, 1 + own.settings.diagnosis_workers)
    for serial in waiting:
        with own.storage.database.writing() as store:
            if store.pending_outlooks.claim(serial, now, now + CLAIM):
                return serial
    return None
