"""A separate process for the computations in the queue: numerical work in threads would slow down requests.

It is forked from one with only the loaded program (`forkserver`), so it inherits no database connection, lock or file
of the service. It ends with the service, when its pipe is closed.
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

POLL_SECONDS = 0.25
"""Seconds between two checks whether the service is stopping during a diagnosis."""
CONTEXT = multiprocessing.get_context("forkserver")
"""Start method of the processes."""
NICENESS = 10
"""Priority, as `nice` counts: where all cores are busy a request gets nine tenths of one."""


KeepGoing = Callable[[], bool]
"""Whether the service goes on; called repeatedly during the work."""
DIED, LATE = "ProcessDied", "TookTooLong"
"""Names in the metrics of a process that died, and of one that was ended at its time limit."""


class StoppingError(ServiceError):
    """The service stops: the process was ended during its work."""


class Helper:
    """A process that makes one diagnosis after another, replaced when it dies."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._process: BaseProcess | None = None
        self._pipe: Connection | None = None

    def start(self) -> None:
        """Starts it where it is not running."""
        if self._process is not None and self._process.is_alive():
            return
        self.end()
        CONTEXT.set_forkserver_preload([__name__])
        ours, theirs = CONTEXT.Pipe()
        args = (theirs, self._settings, limits.in_force())
        self._process = CONTEXT.Process(target=work, args=args, name="diagnoses", daemon=True)
        self._process.start()
        theirs.close()
        self._pipe = ours

    def make(self, kind: Kind, subject: str, now: datetime, keep_going: KeepGoing) -> Failure | None:
        """Makes and stores a piece of work, as long as ``keep_going`` is true."""
        if not keep_going():
            raise StoppingError(f"The {kind.kind} of {subject} was not begun.")
        self.start()
        assert self._pipe is not None
        answered = False
        try:
            self._pipe.send((kind.kind, subject, now))
            while not self._pipe.poll(POLL_SECONDS):
                if not keep_going():
                    raise StoppingError(f"The {kind.kind} of {subject} was interrupted.")
            answer: Failure | None = self._pipe.recv()
            answered = True
        except (EOFError, OSError):
            return self._ended(kind.kind, subject)
        finally:
            if not answered:  # its answer would be taken for that of the next job
                self.end()
        return answer

    def _ended(self, kind: WorkKind, subject: str) -> Failure:
        assert self._process is not None
        self._process.join()
        if self._process.exitcode == -signal.SIGALRM:
            return Failure(LATE, too_long(limits.in_force().work), is_foreseen=False)
        return Failure(DIED, f"The process died at the {kind} of {subject}.", is_foreseen=False)

    def end(self) -> None:
        """Ends it at once: an open transaction is rolled back."""
        if self._pipe is not None:
            self._pipe.close()
        if self._process is not None:
            self._process.kill()
            self._process.join()
            self._process.close()
        self._process = self._pipe = None


def work(pipe: Connection, settings: Settings, most: Limits) -> None:
    """Does requested work in the process until the pipe is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # of a terminal; the service decides
    os.nice(NICENESS)  # a request that waits for what it holds leaves it the core
    limits.use(most)
    write_log()
    storage = open_storage(settings)
    with suppress(EOFError, BrokenPipeError, ConnectionResetError):
        while True:
            kind, subject, now = pipe.recv()
            signal.setitimer(signal.ITIMER_REAL, most.work)  # ends the process, whatever it is at
            answer = _made(storage, KINDS[kind], subject, now, settings.coverage_factor)
            signal.setitimer(signal.ITIMER_REAL, 0)
            pipe.send(answer)


def _made(storage: Storage, kind: Kind, subject: str, now: datetime, coverage_factor: float) -> Failure | None:
    assert kind.make is not None
    with ending_here(kind.kind.value, subject) as outcome:
        kind.make(storage, subject, now, coverage_factor)
    return outcome.failure
