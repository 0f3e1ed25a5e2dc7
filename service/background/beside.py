"""Work beside the requests: what a process that makes diagnoses and outlooks does, one after another."""

from threading import Event

from service.background.diagnose_waiting import WORK, Diagnosing, diagnose_next
from service.background.guard import Guard
from service.background.helper import Helper
from service.background.pool_waiting import pool_next
from service.background.refresh_waiting import refresh_next

LOOK_EVERY = 1.0
"""Seconds between two looks at what other services left; what this one takes in rings."""
RETRY = 60.0
"""Seconds after a look that failed, as when the database is away."""


def work_beside(own: Diagnosing, stop: Event) -> None:
    """Makes what is asked for until ``stop`` is set."""
    helper = Helper(own.settings)
    try:
        while not stop.is_set():
            rung, guard = own.bell.rung, Guard(own.metrics)
            with guard.alone(WORK, ""):
                helper.start()
                while not stop.is_set() and _work(own, helper, stop):
                    rung = own.bell.rung
            own.bell.wait(rung, RETRY if guard.failed else LOOK_EVERY)
    finally:
        helper.end()


def _work(own: Diagnosing, helper: Helper, stop: Event) -> bool:
    """A diagnosis and an outlook, so that neither waits for all of the other; whether there was any. A group waits for
    both: every diagnosis changes what it rests on."""
    refreshed = refresh_next(own, helper, stop)
    return diagnose_next(own, helper, stop) or refreshed or pool_next(own, helper, stop)
