"""The database: the only place that commits. One transaction a request.

`service.kit.lock_order` defines the order of locks, and the work that is not done while one is held.
"""

from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from copy import copy
from datetime import datetime
from typing import TYPE_CHECKING

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from estimator.message import say
from estimator.on_demand import function_on_demand
from service.errors import AwayError
from service.kit.lock_order import writing
from service.storage.audit import Audit
from service.storage.engine import WRITES, open_engine
from service.storage.faults import database_faults
from service.storage.queries import BeforeCommit, Store
from service.storage.waits import FairLock, Waits

if TYPE_CHECKING:
    from service.storage.schema import head_revision, is_known, stored_revision
else:
    head_revision = function_on_demand("service.storage.schema", "head_revision")
    is_known = function_on_demand("service.storage.schema", "is_known")
    stored_revision = function_on_demand("service.storage.schema", "stored_revision")


class Database:
    """Provides transactions."""

    def __init__(self, url: str, before_commit: BeforeCommit, waits: Waits | None = None) -> None:
        self.url, self._before_commit, self._account = url, before_commit, ""
        self.engine = open_engine(url, waits)
        self._turns = FairLock((waits or Waits()).lock) if self.engine.name == "sqlite" else None
        self._writing_engine = self.engine.execution_options(**{WRITES: True})

    def acting(self, account: str) -> "Database":
        """The database for an account: its audit lines name it."""
        database = copy(self)
        database._account = account
        return database

    @contextmanager
    def reading(self) -> Iterator[Store]:
        """A read transaction. On PostgreSQL each query sees what was committed before it."""
        with database_faults(), Session(self.engine, autoflush=False) as session:
            yield Store(session)

    @contextmanager
    def writing(self) -> Iterator[Store]:
        """A write transaction: committed when the block ends, rolled back when it raises.

        SQLite has one writer at a time, and does not queue waiting writers fairly: those of this process are queued
        here.
        """
        turn = nullcontext() if self._turns is None else self._turns.taken()
        with database_faults(), writing(), turn, Session(self._writing_engine) as session:
            store = Store(session, self._account)
            yield store
            self._before_commit(store)
            Audit(store).seal()
            session.commit()

    @contextmanager
    def trying(self) -> Iterator[Store]:
        """A write transaction that is undone when the block ends: what a change would lead to."""
        turn = nullcontext() if self._turns is None else self._turns.taken()
        with database_faults(), writing(), turn, Session(self._writing_engine) as session:
            yield Store(session, self._account)

    def require_ready(self) -> None:
        """AwayError unless the database answers and has the schema of this version."""
        with database_faults(), self.engine.connect() as connection:
            revision = stored_revision(connection)
        fault = unfit(revision)
        if fault is not None:
            raise AwayError(fault)

    def server_time(self) -> datetime | None:
        """The clock of the database server; None where it is on this machine."""
        if self.engine.name == "sqlite":
            return None
        with database_faults(), self.engine.connect() as connection:
            time: datetime = connection.execute(select(func.clock_timestamp())).scalar_one()
            return time

    def close(self) -> None:
        """Closes every connection."""
        self.engine.dispose()


def unfit(revision: str | None) -> str | None:
    """The reason why this version cannot work with a revision; None for the one that it needs."""
    needed = head_revision()
    if revision == needed:
        return None
    if revision is not None and not is_known(revision):
        return say(
            "The database's schema is at {revision}, which a newer version of the program made; this "
            "one goes up to {needed_revision}: run the newer version.",
            revision=revision,
            needed_revision=needed,
        )
    return say(
        "The database's schema is at {revision}, this version needs {needed_revision}: run `imu-health db upgrade`.",
        revision=revision or "nothing",
        needed_revision=needed,
    )
