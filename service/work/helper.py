"""A process of its own that makes what waits in the queue: numerical work in threads stands in the way of requests.

It is forked from one that holds nothing but the loaded program (`forkserver`), so that it has no connection to the
database, no lock and no file of the service's. It ends with the service: it reads the end of its pipe.
"""

import multiprocessing
import os
import signal
from collections.abc import Callable
from contextlib import suppress
from datetime import datetime
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess

from service.errors import ServiceError
from service.kit import limits
from service.kit.failure import too_long
from service.kit.guard import Failure, ending_here
from service.kit.limits import Limits
from service.kit.log import write_log
from service.opening import open_storage
from service.queue.records import WorkKind
from service.settings import Settings
from service.storage import Storage
from service.work.kinds import KINDS, Kind

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

    def make(self, kind: Kind, of: str, now: datetime, still: Still) -> Failure | None:
        """Makes and stores a piece of work, while ``still`` says to go on."""
        if not still():
            raise StoppingError(f"The {kind.kind} of {of} was not begun.")
        self.start()
        assert self._pipe is not None
        answered = False
        try:
            self._pipe.send((kind.kind, of, now))
            while not self._pipe.poll(LOOK_EVERY):
                if not still():
                    raise StoppingError(f"The {kind.kind} of {of} was interrupted.")
            answer: Failure | None = self._pipe.recv()
            answered = True
        except (EOFError, OSError):
            return self._ended(kind.kind, of)
        finally:
            if not answered:  # its answer would be taken for that of the next job
                self.end()
        return answer

    def _ended(self, kind: WorkKind, of: str) -> Failure:
        """Why it answers no more."""
        assert self._process is not None
        self._process.join()
        if self._process.exitcode == -signal.SIGALRM:
            return Failure(LATE, too_long(limits.in_force().work), is_foreseen=False)
        return Failure(DIED, f"The process died at the {kind} of {of}.", is_foreseen=False)

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
    os.nice(NICENESS)  # a request that waits for what it holds leaves it the core
    limits.use(most)
    write_log()
    storage = open_storage(settings)
    with suppress(EOFError, BrokenPipeError, ConnectionResetError):
        while True:
            kind, of, now = pipe.recv()
            signal.setitimer(signal.ITIMER_REAL, most.work)  # ends the process, whatever it is at
            answer = _made(storage, KINDS[kind], of, now, settings.coverage_factor)
            signal.setitimer(signal.ITIMER_REAL, 0)
            pipe.send(answer)


def _made(storage: Storage, kind: Kind, of: str, now: datetime, coverage_factor: float) -> Failure | None:
    assert kind.make is not None
    with ending_here(kind.kind.value, of) as met:
        kind.make(storage, of, now, coverage_factor)
    return met.failure
