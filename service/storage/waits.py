"""Timeouts of the database, so that one that is locked, frozen or gone is noticed."""

from collections import deque
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from threading import Lock
from time import monotonic
from typing import Any

import psycopg
from psycopg.abc import PQGen

from service.errors import AwayError
from service.storage.faults import AWAY


class FairLock:
    """One holder at a time, first come, first served."""

    def __init__(self, patience: float) -> None:
        self._patience = patience
        """Seconds without any turn ending after which a waiter gives up: a long queue is no fault."""
        self._own, self._line, self._ended = Lock(), deque[Lock](), 0

    @contextmanager
    def taken(self) -> Iterator[None]:
        """A turn; AwayError where its holder takes too long."""
        place, ended = self._come(), self._ended
        try:
            while not place.acquire(timeout=self._patience):
                if self._ended == ended:
                    raise AwayError(AWAY)
                ended = self._ended
            yield
        finally:
            self._leave(place)

    def _come(self) -> Lock:
        place = Lock()
        with self._own:
            if self._line:
                place.acquire()
            self._line.append(place)
        return place

    def _leave(self, place: Lock) -> None:
        """Leaves the queue; the holder frees the next place."""
        with self._own:
            was_first = self._line[0] is place
            self._line.remove(place)
            self._ended += was_first
            if was_first and self._line:
                self._line[0].release()

    def __len__(self) -> int:
        """Holder and waiters."""
        return len(self._line)


GRACE = 5.0
"""Seconds after which a server that should have timed out by itself counts as frozen."""
POLL_SECONDS = 0.1
"""Seconds between two checks of the clock while a server works."""


@dataclass(frozen=True)
class Waits:
    """Seconds after which the database counts as unavailable."""

    lock: float = 10.0
    """Timeout for a lock held by another transaction, s."""
    statement: float | None = 30.0
    """Timeout for one statement, on PostgreSQL, s; None for no limit."""
    connect: float = 5.0
    """Timeout for a connection, s."""


def waits_of(patience: float) -> Waits:
    """The timeouts from one setting: it holds for a lock, three times this for a statement, and half of it for
    connecting.
    """
    return Waits(lock=patience, statement=3 * patience, connect=patience / 2)


PATIENT = Waits(lock=600.0, statement=None)
"""Timeouts of migrations, backups and restoring: another one may be running, and a large table takes minutes."""


def connect_within(waits: Waits, arguments: dict[str, Any]) -> psycopg.Connection[Any]:
    """A connection to PostgreSQL that times out: on the server by its settings, and on this side when it does not.

    An operator's own `options` in the database's address come after these and win.
    """
    milliseconds = {"lock_timeout": waits.lock, "statement_timeout": waits.statement or 0.0}
    options = [f"-c {name}={round(1000 * seconds)}" for name, seconds in milliseconds.items()]
    kwargs = {"connect_timeout": max(round(waits.connect), 2)} | arguments
    kwargs["options"] = " ".join([*options, arguments.get("options", "")]).strip()
    kind = psycopg.Connection if waits.statement is None else _impatient(waits.statement + GRACE)
    return kind.connect(**kwargs)


def _impatient(limit: float) -> type[psycopg.Connection[Any]]:
    """Connections that close when a server does not answer in time, as a frozen one does."""

    class Impatient(psycopg.Connection[Any]):
        def wait(self, gen: PQGen[Any], interval: float = POLL_SECONDS, timeout: float | None = None) -> Any:
            try:
                return super().wait(_until(gen, monotonic() + limit), interval, timeout)
            except ServerFrozen:
                self.pgconn.finish()
                raise

    return Impatient


class ServerFrozen(psycopg.OperationalError):
    """The server did not answer, nor did it time out by itself."""


def _until(work: PQGen[Any], end: float) -> Generator[Any, Any, Any]:
    """The work, ended with an error after its deadline."""
    try:
        state = next(work)
        while True:
            ready = yield state
            if not ready and monotonic() > end:
                raise ServerFrozen("the server does not answer")
            state = work.send(ready)
    except StopIteration as done:
        return done.value
