"""How long the database is waited for, so that one that is locked, frozen or gone is noticed."""

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


class Turns:
    """One at a time; nobody overtakes."""

    def __init__(self, patience: float) -> None:
        self._patience = patience
        """Seconds without anybody's turn ending after which one that waits gives up: a long line is no fault."""
        self._own, self._line, self._ended = Lock(), deque[Lock](), 0

    @contextmanager
    def taken(self) -> Iterator[None]:
        """A turn; AwayError where whoever has it takes too long."""
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
        """The last place in the line; the first one is open."""
        place = Lock()
        with self._own:
            if self._line:
                place.acquire()
            self._line.append(place)
        return place

    def _leave(self, place: Lock) -> None:
        """Opens the place of the next, where it was the first that left."""
        with self._own:
            was_first = self._line[0] is place
            self._line.remove(place)
            self._ended += was_first
            if was_first and self._line:
                self._line[0].release()

    def __len__(self) -> int:
        """Who has the turn, and who waits."""
        return len(self._line)


GRACE = 5.0
"""Seconds after which a server that should have given up by itself counts as frozen."""
LOOKS = 0.1
"""Seconds between two looks at the clock while a server works."""


@dataclass(frozen=True)
class Waits:
    """Seconds after which the database counts as away."""

    lock: float = 10.0
    """For a lock that another transaction holds."""
    statement: float | None = 30.0
    """For one statement, on PostgreSQL; None waits as long as it takes."""
    connect: float = 5.0
    """For a connection."""


def waits_of(patience: float) -> Waits:
    """One patience: a lock is waited for as long as it says, a statement may work thrice that, and whoever does not
    connect in half of it is away."""
    return Waits(lock=patience, statement=3 * patience, connect=patience / 2)


PATIENT = Waits(lock=600.0, statement=None)
"""For migrations, backups and restoring: another one may be at it, and a large table takes minutes."""


def connect_within(waits: Waits, arguments: dict[str, Any]) -> psycopg.Connection[Any]:
    """A connection to PostgreSQL that gives up in time: the server by its own settings, and this side when it does not.

    An operator's own `options` in the database's address come after these and win.
    """
    milliseconds = {"lock_timeout": waits.lock, "statement_timeout": waits.statement or 0.0}
    options = [f"-c {name}={round(1000 * seconds)}" for name, seconds in milliseconds.items()]
    own = {"connect_timeout": max(round(waits.connect), 2)} | arguments
    own["options"] = " ".join([*options, arguments.get("options", "")]).strip()
    kind = psycopg.Connection if waits.statement is None else _impatient(waits.statement + GRACE)
    return kind.connect(**own)


def _impatient(most: float) -> type[psycopg.Connection[Any]]:
    """Connections that close when a server says nothing for so long, as a frozen one does."""

    class Impatient(psycopg.Connection[Any]):
        def wait(self, gen: PQGen[Any], interval: float = LOOKS, timeout: float | None = None) -> Any:
            try:
                return super().wait(_until(gen, monotonic() + most), interval, timeout)
            except ServerFrozen:
                self.pgconn.finish()
                raise

    return Impatient


class ServerFrozen(psycopg.OperationalError):
    """The server did not answer, nor did it give up by itself."""


def _until(work: PQGen[Any], end: float) -> Generator[Any, Any, Any]:
    """The same work, which ends with an error when its time is over."""
    try:
        state = next(work)
        while True:
            ready = yield state
            if not ready and monotonic() > end:
                raise ServerFrozen("the server does not answer")
            state = work.send(ready)
    except StopIteration as done:
        return done.value
