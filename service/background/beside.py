"""Work beside the requests: what a process of its own makes, one after another."""

from threading import Event

from service.background.diagnose_waiting import WORK, Diagnosing, diagnose_next
from service.background.helper import Helper
from service.background.job_waiting import work_on_next
from service.background.pool_waiting import pool_next
from service.background.recompute_waiting import recompute_next
from service.background.refresh_waiting import refresh_next
from service.background.summarise_waiting import summarise_next
from service.flows.guard import Guard

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
    """A diagnosis, an outlook, a unit under another model and a piece of long work, so that none waits for all of the
    others; whether there was any. Summaries wait for all outlooks, and a group waits for all: every diagnosis changes
    what it rests on."""
    refreshed = refresh_next(own, helper, stop)
    recomputed = recompute_next(own, helper, stop)
    worked = work_on_next(own, helper, stop)
    if diagnose_next(own, helper, stop) or refreshed or recomputed or worked:
        return True
    return summarise_next(own, helper, stop) or pool_next(own, helper, stop)
