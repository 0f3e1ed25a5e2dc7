"""Work beside the requests: what a process of its own makes, one after another."""

from threading import Event

from service.kit.guard import Guard
from service.work.helper import Helper
from service.work.kinds import AT_LAST, DIAGNOSES, IN_TURN
from service.work.loop import Worker, work_next

LOOK_EVERY = 1.0
"""Seconds between two looks at what other services left; what this one takes in rings."""
RETRY = 60.0
"""Seconds after a look that failed, as when the database is away."""


def work_beside(own: Worker, stop: Event) -> None:
    """Makes what is asked for until ``stop`` is set."""
    helper = Helper(own.settings)
    try:
        while not stop.is_set():
            rung, guard = own.bell.rung, Guard(own.metrics)
            with guard.alone(DIAGNOSES.name, ""):
                helper.start()
                while not stop.is_set() and _work(own, helper, stop):
                    rung = own.bell.rung
            own.bell.wait(rung, RETRY if guard.failed else LOOK_EVERY)
    finally:
        helper.end()


def _work(own: Worker, helper: Helper, stop: Event) -> bool:
    """One piece of each kind that has its turn, else one of the others; whether there was any."""
    worked = [work_next(own, helper.make, stop, kind) for kind in IN_TURN]
    return any(worked) or any(work_next(own, helper.make, stop, kind) for kind in AT_LAST)
