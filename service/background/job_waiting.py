"""Work beside the requests: long work that somebody asked for, piece by piece, so that nothing waits for all of it."""

from threading import Event

from service.background.claimed import Work, work_next
from service.background.diagnose_waiting import Diagnosing
from service.background.helper import Helper
from service.background.work_job import skip_piece

JOBS = Work("jobs", queue=lambda store: store.jobs, make=Helper.work_on, give_up=skip_piece)


def work_on_next(own: Diagnosing, helper: Helper, stop: Event) -> bool:
    """Does a piece of the job whose turn it is; whether there was one."""
    return work_next(own, helper, stop, JOBS)
