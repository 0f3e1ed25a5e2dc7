"""The database: the only place that commits. One transaction a request.

In which order locks are taken, and what is not done while one is held, says `service.kit.lock_order`.
"""

from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from copy import copy
from datetime import datetime

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from service.errors import AwayError
from service.kit.lock_order import writing
from service.storage.audit import Audit
from service.storage.engine import WRITES, open_engine
from service.storage.faults import database_faults
from service.storage.queries import BeforeCommit, Store
from service.storage.revisions import unfit
from service.storage.schema import stored_revision
from service.storage.waits import Turns, Waits


class Database:
    """Hands out one transaction at a time."""

    def __init__(self, url: str, before_commit: BeforeCommit, waits: Waits | None = None) -> None:
        self.url, self._before_commit, self._account = url, before_commit, ""
        self.engine = open_engine(url, waits)
        self._turns = Turns((waits or Waits()).lock) if self.engine.name == "sqlite" else None
        self._writing_engine = self.engine.execution_options(**{WRITES: True})

    def acting(self, account: str) -> "Database":
        """The same database; what it writes into the audit trail names an account."""
        own = copy(self)
        own._account = account
        return own

    @contextmanager
    def reading(self) -> Iterator[Store]:
        """To read; nothing of it is kept. On PostgreSQL each question sees what was committed before it."""
        with database_faults(), Session(self.engine, autoflush=False) as session:
            yield Store(session)

    @contextmanager
    def writing(self) -> Iterator[Store]:
        """One transaction: committed when the block ends, undone when it raises.

        SQLite has one writer at a time, and forgets who waited longest: those of this process come in turn.
        """
        turn = nullcontext() if self._turns is None else self._turns.taken()
        with database_faults(), writing(), turn, Session(self._writing_engine) as session:
            store = Store(session, self._account)
            yield store
            self._before_commit(store)
            Audit(store).seal()
            session.commit()

    def require_ready(self) -> None:
        """AwayError unless the database answers and its schema is the one this version needs."""
        with database_faults(), self.engine.connect() as connection:
            found = stored_revision(connection)
        fault = unfit(found)
        if fault is not None:
            raise AwayError(fault)

    def server_time(self) -> datetime | None:
        """What the database's own clock says; None where it has none but this machine's."""
        if self.engine.name == "sqlite":
            return None
        with database_faults(), self.engine.connect() as connection:
            found: datetime = connection.execute(select(func.clock_timestamp())).scalar_one()
            return found

    def close(self) -> None:
        """Gives back every connection."""
        self.engine.dispose()
