"""Engines: SQLite with write-ahead log, foreign keys and patience; PostgreSQL through psycopg 3."""

import sqlite3
from pathlib import Path

from sqlalchemy import URL, Connection, Engine, create_engine, event, make_url
from sqlalchemy.exc import ArgumentError
from sqlalchemy.pool import ConnectionPoolEntry

from service.errors import ServiceError

BUSY_TIMEOUT_MS = 10_000
"""Milliseconds that a connection waits for another one's write lock before the database counts as away."""
WAIT_FOR_CONNECTION, WAIT_FOR_SERVER = 10, 5
"""Seconds for a free connection of the pool, and for PostgreSQL to answer, before it counts as away."""
WRITES = "imu_health_writes"
"""Execution option of a connection that will write."""


def normal_url(url: str) -> URL:
    """The URL with psycopg 3 as PostgreSQL's driver, whatever spelling an operator used; ServiceError for any other."""
    try:
        parsed = make_url(url)
    except (ArgumentError, ValueError) as fault:
        raise _unknown("It cannot be read") from fault
    if parsed.drivername in ("postgres", "postgresql", "postgresql+psycopg"):
        return parsed.set(drivername="postgresql+psycopg")
    if parsed.drivername != "sqlite":
        raise _unknown(f"It names {parsed.drivername!r}")
    return parsed


def _unknown(fault: str) -> ServiceError:
    """The address itself may hold a password and is not repeated."""
    return ServiceError(f"{fault}: a database's address is sqlite:///path or postgresql://user:password@host/name.")


def open_engine(url: str) -> Engine:
    """An engine for the database; the folder of an SQLite file is made when it is missing.

    Its errors repeat statements without their values, so that no secret and no upload comes into a log with them.
    """
    parsed = normal_url(url)
    if parsed.get_backend_name() != "sqlite":
        return create_engine(
            parsed, hide_parameters=True, pool_pre_ping=True, pool_timeout=10, connect_args={"connect_timeout": 5}
        )
    if parsed.database and parsed.database != ":memory:":
        Path(parsed.database).parent.mkdir(parents=True, exist_ok=True)
    engine = create_engine(parsed, hide_parameters=True)
    event.listen(engine, "connect", _prepare_sqlite)
    event.listen(engine, "begin", _begin_sqlite)
    return engine


def _prepare_sqlite(connection: sqlite3.Connection, _: ConnectionPoolEntry) -> None:
    """Leaves transactions to `_begin_sqlite`, and makes a commit durable and a reader never block a writer."""
    connection.isolation_level = None
    for pragma in (
        f"busy_timeout={BUSY_TIMEOUT_MS}", "journal_mode=WAL", "synchronous=FULL", "foreign_keys=ON"
    ):  # fmt: skip
        connection.execute(f"PRAGMA {pragma}").close()


def _begin_sqlite(connection: Connection) -> None:
    """A writer takes the write lock at once, so that waiting for it never fails half-way."""
    writes = connection.get_execution_options().get(WRITES)
    connection.exec_driver_sql("BEGIN IMMEDIATE" if writes else "BEGIN")
