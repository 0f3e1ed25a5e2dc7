"""Errors of a database driver or a disk that mean "unavailable" or "full"."""

import errno
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager

from sqlalchemy.exc import DBAPIError, InterfaceError, OperationalError
from sqlalchemy.exc import TimeoutError as PoolTimeout

from service.errors import AwayError, NoSpaceError, ServiceError

FULL_SQLSTATES = frozenset({"53100"})
"""PostgreSQL: disk_full."""
DAMAGED = frozenset({sqlite3.SQLITE_NOTADB, sqlite3.SQLITE_CORRUPT})
"""SQLite: the file cannot be read as a database."""
NOT_OPENED = frozenset({sqlite3.SQLITE_READONLY, sqlite3.SQLITE_CANTOPEN, sqlite3.SQLITE_PERM})
"""SQLite: the file cannot be opened or written, and waiting does not help."""
PRIMARY = 0xFF
"""Bits of an SQLite error code with its kind; the others are details."""
FULL_ERRNOS = frozenset({errno.ENOSPC, errno.EDQUOT})
"""The disk, or the service's quota, is full."""
NO_SPACE = "The disk is full: nothing was stored. Free some space and send it again."
NO_DATABASE = "The database's file is damaged, or is not an SQLite database."
NOT_WRITABLE = (
    "The database's file cannot be opened or written. Nothing was stored. Check that it and its folder are there, "
    "and that the user of the service may write them."
)
NO_FOLDER = (
    "The folder of uploaded files cannot be written ({reason}): nothing was stored. Check that it is there, and that "
    "the user of the service may write it; then send it again."
)
AWAY = "The database does not answer. Nothing was lost; try again in a few seconds."
"""Messages to the user: the state, and what to do."""


@contextmanager
def database_faults() -> Iterator[None]:
    """Turns a driver's "cannot connect", "went away", "busy" and "disk full" into errors of the service."""
    try:
        yield
    except PoolTimeout as fault:
        raise AwayError(AWAY) from fault
    except DBAPIError as fault:
        if _is_full(fault):
            raise NoSpaceError(NO_SPACE) from fault
        if _sqlite_code(fault) in DAMAGED:
            raise ServiceError(NO_DATABASE) from fault
        if _sqlite_code(fault) in NOT_OPENED:
            raise AwayError(NOT_WRITABLE) from fault
        if fault.connection_invalidated or isinstance(fault, OperationalError | InterfaceError):
            raise AwayError(AWAY) from fault
        raise


@contextmanager
def disk_faults() -> Iterator[None]:
    """Turns "no space left on device" and "may not be written" into errors of the service."""
    try:
        yield
    except OSError as fault:
        if fault.errno in FULL_ERRNOS:
            raise NoSpaceError(NO_SPACE) from fault
        raise AwayError(NO_FOLDER, reason=fault.strerror or fault) from fault


def _is_full(fault: DBAPIError) -> bool:
    sqlstate = getattr(fault.orig, "sqlstate", None)
    return _sqlite_code(fault) == sqlite3.SQLITE_FULL or sqlstate in FULL_SQLSTATES


def _sqlite_code(fault: DBAPIError) -> int | None:
    """SQLite's error code; None for another database, or an error without one."""
    code = getattr(fault.orig, "sqlite_errorcode", None)
    return None if code is None else code & PRIMARY
