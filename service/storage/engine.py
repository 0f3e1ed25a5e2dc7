"""Engines: SQLite with write-ahead log, foreign keys and a lock timeout; PostgreSQL through psycopg 3."""

import sqlite3
from collections.abc import Callable
from pathlib import Path
from time import monotonic, sleep
from typing import Any

import psycopg
from sqlalchemy import URL, Connection, Engine, create_engine, event, make_url
from sqlalchemy.engine.interfaces import DBAPIConnection, Dialect
from sqlalchemy.exc import ArgumentError, OperationalError
from sqlalchemy.pool import ConnectionPoolEntry

from service.errors import ServiceError
from service.storage.faults import PRIMARY
from service.storage.folders import make_folder
from service.storage.json_text import json_text
from service.storage.waits import Waits, connect_within

RETRY_SECONDS = 0.02
"""Seconds between two attempts at an operation that SQLite refuses at once while another process does the same."""
WRITE_RETRY_SECONDS = 0.005
"""Seconds between two attempts at SQLite's write lock. Its own busy handler backs off to a tenth of a second, which
starves a long waiter; with equal steps every process has the same chance."""
WRITES = "imu_health_writes"
"""Execution option of a connection that writes."""


def normal_url(url: str) -> URL:
    """The URL with psycopg 3 as PostgreSQL's driver, in any accepted spelling; ServiceError for another database."""
    try:
        parsed = make_url(url)
    except (ArgumentError, ValueError) as fault:
        raise _unknown("It cannot be read") from fault
    if parsed.drivername in ("postgres", "postgresql", "postgresql+psycopg"):
        return parsed.set(drivername="postgresql+psycopg")
    if parsed.drivername != "sqlite":
        raise _unknown(f"It names {parsed.drivername!r}")
    return parsed


def shown_url(url: str) -> str:
    """The URL for display: without its password, and without options, which may hold another."""
    return normal_url(url).set(query={}).render_as_string(hide_password=True)


def _unknown(fault: str) -> ServiceError:
    """The URL itself may hold a password and is not repeated."""
    return ServiceError(f"{fault}: a database's address is sqlite:///path or postgresql://user:password@host/name.")


def open_engine(url: str, waits: Waits | None = None) -> Engine:
    """An engine for the database; the folder of an SQLite file is created.

    Its errors show statements without their values, so that no secret and no upload reaches a log with them.
    """
    parsed, waits = normal_url(url), waits or Waits()
    if parsed.get_backend_name() != "sqlite":
        engine = create_engine(
            parsed, hide_parameters=True, json_serializer=json_text, pool_pre_ping=True, pool_timeout=waits.lock
        )
        event.listen(engine, "do_connect", _connecting(waits))
        event.listen(engine, "checkin", _end_transaction)
        return engine
    if not parsed.database or parsed.database == ":memory:":
        raise _unknown("It names no file")
    make_folder(Path(parsed.database).absolute().parent)
    engine = create_engine(parsed, hide_parameters=True, json_serializer=json_text, pool_timeout=waits.lock)
    event.listen(engine, "connect", _preparing(waits))
    event.listen(engine, "begin", _beginning(waits))
    event.listen(engine, "checkin", _end_transaction)
    return engine


def _connecting(waits: Waits) -> Callable[..., psycopg.Connection[Any]]:
    def connect(
        _: Dialect, __: ConnectionPoolEntry, args: list[Any], kwargs: dict[str, Any]
    ) -> psycopg.Connection[Any]:
        assert not args, "psycopg is given its arguments by name"
        return connect_within(waits, kwargs)

    return connect


def _preparing(waits: Waits) -> Callable[[DBAPIConnection, ConnectionPoolEntry], None]:
    """Leaves transactions to `_beginning`; makes commits durable, and readers never block a writer."""

    def prepare(connection: DBAPIConnection, _: ConnectionPoolEntry) -> None:
        assert isinstance(connection, sqlite3.Connection)
        connection.isolation_level = None
        connection.execute(f"PRAGMA busy_timeout={round(1000 * waits.lock)}").close()
        _write_ahead(connection, monotonic() + waits.lock)
        for pragma in ("synchronous=FULL", "foreign_keys=ON"):
            connection.execute(f"PRAGMA {pragma}").close()

    return prepare


def _write_ahead(connection: sqlite3.Connection, end: float) -> None:
    """Sets the journal mode of a new file. When several processes open it at once, SQLite refuses the change to all but
    one.
    """
    while True:
        try:
            connection.execute("PRAGMA journal_mode=WAL").close()
        except sqlite3.OperationalError as fault:
            if not _is_busy(fault) or monotonic() > end:
                raise
            sleep(RETRY_SECONDS)
        else:
            return


def _beginning(waits: Waits) -> Callable[[Connection], None]:
    def begin(connection: Connection) -> None:
        if connection.get_execution_options().get(WRITES):
            _begin_to_write(connection, waits)
        else:
            connection.exec_driver_sql("BEGIN")

    return begin


def _begin_to_write(connection: Connection, waits: Waits) -> None:
    """Takes the write lock at once, so that waiting for it never fails half-way."""
    driver_connection, end = connection.connection.driver_connection, monotonic() + waits.lock
    assert isinstance(driver_connection, sqlite3.Connection)
    driver_connection.execute("PRAGMA busy_timeout=0").close()
    try:
        while not _has_begun(connection, is_last=monotonic() > end):
            sleep(WRITE_RETRY_SECONDS)
    finally:
        driver_connection.execute(f"PRAGMA busy_timeout={round(1000 * waits.lock)}").close()


def _has_begun(connection: Connection, *, is_last: bool) -> bool:
    """Whether the write lock was taken; the last attempt raises."""
    try:
        connection.exec_driver_sql("BEGIN IMMEDIATE")
    except OperationalError as fault:
        if is_last or not _is_busy(fault.orig):
            raise
        return False
    return True


def _is_busy(fault: object) -> bool:
    return isinstance(fault, sqlite3.OperationalError) and fault.sqlite_errorcode & PRIMARY == sqlite3.SQLITE_BUSY


def _end_transaction(connection: DBAPIConnection | None, entry: ConnectionPoolEntry) -> None:
    """A failed commit can leave its transaction open, with its locks: the next user of the connection must not go on
    with it."""
    if connection is None:
        return
    try:
        connection.rollback()
    except (sqlite3.Error, psycopg.Error):
        entry.invalidate()
