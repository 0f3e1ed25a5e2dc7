"""A process of its own that makes diagnoses, outlooks, summaries, what groups show, what follows from other models and
pieces of long work: numerical work in threads stands in the way of requests.

It is forked from one that holds nothing but the loaded program (`forkserver`), so that it has no connection to the
database, no lock and no file of the service's. It ends with the service: it reads the end of its pipe.
"""

import multiprocessing
import os
import signal
from collections.abc import Callable
from contextlib import suppress
from datetime import datetime
from enum import StrEnum
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import Any

from service.background.work_job import work_piece
from service.errors import ServiceError
from service.flows.diagnose import diagnose
from service.flows.guard import Failure, ending_here
from service.flows.recompute import recompute
from service.flows.refresh_beside import refresh_beside
from service.flows.refresh_group import refresh_group
from service.flows.summarise import summarise
from service.ingest import limits
from service.ingest.limits import Limits
from service.ingest.memory import give_back_large_blocks
from service.log import write_log
from service.records.group import Group
from service.records.recomputation import Task
from service.settings import Settings
from service.storage import Storage, open_storage
from service.storage.failed import too_long

LOOK_EVERY = 0.25
"""Seconds between two looks whether the service is stopping while a diagnosis is made."""
ANSWERS = multiprocessing.get_context("forkserver")
"""How processes are started."""
NICENESS = 10
"""How far they stand back, as `nice` counts: where all cores are busy they leave a request nine tenths of one."""


Still = Callable[[], bool]
"""Whether the service goes on; asked now and then while something is made."""
DIED, LATE = "ProcessDied", "TookTooLong"
"""As the figures name a process that ended before it answered, and one that was ended because it was not done in time.
"""


class StoppingError(ServiceError):
    """The service stops: the process was ended at its work."""


class Job(StrEnum):
    """What is made."""

    DIAGNOSIS = "diagnosis"
    """Of a session."""
    OUTLOOK = "outlook"
    """Of a unit."""
    GROUP = "group"
    """What the sessions of a unit, a unit type or a stand show together."""
    MODEL = "model"
    """A unit's sessions under another model."""
    SUMMARY = "summary"
    """How the units of a type drift, or how stands stand."""
    PIECE = "piece"
    """Of long work that somebody asked for."""


class Helper:
    """A process that makes diagnoses one after another; another one takes its place when it died."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._process: BaseProcess | None = None
        self._pipe: Connection | None = None

    def start(self) -> None:
        """Starts it where it is not there."""
        if self._process is not None and self._process.is_alive():
            return
        self.end()
        ANSWERS.set_forkserver_preload([__name__])
        ours, theirs = ANSWERS.Pipe()
        own = (theirs, self._settings, limits.in_force())
        self._process = ANSWERS.Process(target=work, args=own, name="diagnoses", daemon=True)
        self._process.start()
        theirs.close()
        self._pipe = ours

    def diagnose(self, id: str, now: datetime, still: Still) -> Failure | None:
        """Makes and stores a diagnosis, while ``still`` says to go on."""
        return self._answer(Job.DIAGNOSIS, id, now, still)

    def refresh(self, serial: str, now: datetime, still: Still) -> Failure | None:
        """The same for the outlook of a unit."""
        return self._answer(Job.OUTLOOK, serial, now, still)

    def pool(self, group: Group, now: datetime, still: Still) -> Failure | None:
        """The same for what a group of sessions shows."""
        return self._answer(Job.GROUP, group, now, still)

    def summarise(self, group: Group, now: datetime, still: Still) -> Failure | None:
        """The same for how the units of a type drift, or how stands stand."""
        return self._answer(Job.SUMMARY, group, now, still)

    def recompute(self, task: Task, now: datetime, still: Still) -> Failure | None:
        """The same for a unit's sessions under another model."""
        return self._answer(Job.MODEL, task, now, still)

    def work_on(self, id: int, now: datetime, still: Still) -> Failure | None:
        """The same for a piece of long work."""
        return self._answer(Job.PIECE, id, now, still)

    def _answer(self, job: Job, of: str | int | Group | Task, now: datetime, still: Still) -> Failure | None:
        if not still():
            raise StoppingError(f"The {job} of {of} was not begun.")
        self.start()
        assert self._pipe is not None
        answered = False
        try:
            self._pipe.send((job, of, now))
            while not self._pipe.poll(LOOK_EVERY):
                if not still():
                    raise StoppingError(f"The {job} of {of} was interrupted.")
            answer: Failure | None = self._pipe.recv()
            answered = True
        except (EOFError, OSError):
            return self._ended(job, of)
        finally:
            if not answered:  # its answer would be taken for that of the next job
                self.end()
        return answer

    def _ended(self, job: Job, of: str | int | Group | Task) -> Failure:
        """Why it answers no more."""
        assert self._process is not None
        self._process.join()
        if self._process.exitcode == -signal.SIGALRM:
            return Failure(LATE, too_long(limits.in_force().work), is_foreseen=False)
        return Failure(DIED, f"The process died at the {job} of {of}.", is_foreseen=False)

    def end(self) -> None:
        """Ends it, whatever it is at: a transaction of its is undone."""
        if self._pipe is not None:
            self._pipe.close()
        if self._process is not None:
            self._process.kill()
            self._process.join()
            self._process.close()
        self._process = self._pipe = None


def work(pipe: Connection, settings: Settings, most: Limits) -> None:
    """In the process: makes what is asked for until nobody is there to ask."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # of a terminal; the service decides
    give_back_large_blocks()  # a long log is read whole for its noise
    os.nice(NICENESS)  # a request that waits for what it holds leaves it the core
    limits.use(most)
    write_log()
    storage = open_storage(settings)
    with suppress(EOFError, BrokenPipeError, ConnectionResetError):
        while True:
            job, of, now = pipe.recv()
            signal.setitimer(signal.ITIMER_REAL, most.work)  # ends the process, whatever it is at
            answer = _made(storage, job, of, now, settings.coverage_factor)
            signal.setitimer(signal.ITIMER_REAL, 0)
            pipe.send(answer)


def _made(storage: Storage, job: Job, of: Any, now: datetime, coverage_factor: float) -> Failure | None:
    with ending_here(job.value, str(of)) as met:
        if job is Job.GROUP:
            refresh_group(storage, of, now)
        elif job is Job.OUTLOOK:
            refresh_beside(storage, of, now)
        elif job is Job.SUMMARY:
            summarise(storage, of, now)
        elif job is Job.PIECE:
            work_piece(storage, of, now, coverage_factor)
        elif job is Job.MODEL:
            recompute(storage, of, now, coverage_factor)
        else:
            diagnose(storage, of, now, coverage_factor)
    return met.failure
