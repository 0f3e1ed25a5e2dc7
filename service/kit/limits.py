"""Limits of requests, files and work, so that a small file cannot become a big one in memory.

Like the limits that an operating system sets a process, these are one set a process: `create_app` takes them from the
settings, every other program from the environment. They go together (more cells need more memory and more time), so an
operator chooses the size of the machine and not each of them.
"""

from dataclasses import dataclass, replace

from estimator.errors import FormatError, Problem
from estimator.message import say
from estimator.reading import Extent
from service.settings import Settings

KIBIBYTE, MEBIBYTE, GIBIBYTE = 1024, 1024**2, 1024**3


@dataclass(frozen=True)
class Limits:
    """Limits of one machine; the defaults are those of a small one."""

    rows: int = 2_000_000
    """Rows of an uploaded table."""
    columns: int = 10_000
    """Columns of a table; an array of a thousand triads has a third."""
    cells: int = 2_000_000
    """Rows × columns of a table: about 60 bytes of `memory` each."""
    log_cells: int = 500_000_000
    """Rows × columns of a raw log that is averaged while it is scanned: an hour of six sensors at 20 kHz."""
    whole: int = 64 * MEBIBYTE
    """Bytes of an upload that is read whole: as many cells as JSON."""
    log: int = 2 * GIBIBYTE
    """Bytes of an upload of CSV or Parquet; beyond `whole` it must be a raw log."""
    attached: int = 32 * MEBIBYTE
    """Bytes of a file that is attached to a unit or a session: a scanned paper has a tenth."""
    body: int = 256 * KIBIBYTE
    """Bytes of any other request, such as a note or a form."""
    later: int = 8 * MEBIBYTE
    """Bytes of the largest upload that its sender always waits for; larger ones may be read as jobs."""
    nesting: int = 32
    """Lists and objects of JSON within each other; a session has five."""
    unpacked: int = 128 * MEBIBYTE
    """Bytes, of an archive's or a file's compressed parts."""
    seconds: int = 20
    """Seconds of computing; on a busy machine reading may take `WAITING` times as long."""
    memory: int = 224 * MEBIBYTE
    """Bytes, of the process that reads the file: what the cells take, and the reader itself."""
    at_once: int = 2
    """Files that are read apart at the same time."""
    in_flight: int = 4
    """Large uploads that are received or worked on at once; more are rejected with Retry-After."""
    work: float = 600.0
    """Seconds that one piece of work in the background may take; the largest diagnosis takes tens of them."""
    free: int = 256 * MEBIBYTE
    """Bytes that the disk of uploaded files keeps free: a database on it needs room to finish open transactions."""

    client: float = 10.0
    """Seconds that a client is waited for, beside what a slow line needs for its bytes."""
    connections: int = 500
    """Connections open at once; each costs some 100 kB."""

    @property
    def extent(self) -> Extent:
        """Limits for the estimator's reader."""
        return Extent(rows=self.rows, columns=self.columns, cells=self.cells, nesting=self.nesting)


SMALL = Limits()
"""Limits for 2 GB of memory: two readers, the service and a diagnosis fit."""
TIMES = 4
"""Ratio of the limits of a large machine to those of a small one."""
SCALED = ("rows", "cells", "log_cells", "whole", "log", "attached", "unpacked", "seconds", "memory", "work")
"""Limits that grow with the machine: the size of one file, and the time and memory that it takes."""
LARGE = replace(SMALL, **{name: TIMES * getattr(SMALL, name) for name in SCALED})
"""Limits for 8 GB of memory."""


class _InForce:
    limits: Limits | None = None


def limits_of(settings: Settings) -> Limits:
    """The limits of the machine in the settings."""
    return LARGE if settings.machine == "large" else SMALL


def in_force() -> Limits:
    """The limits of this process."""
    if _InForce.limits is None:
        _InForce.limits = limits_of(Settings())
    return _InForce.limits


def use(limits: Limits) -> None:
    """Sets them for this process."""
    _InForce.limits = limits


def refusal(filename: str, message: str, field: str = "file", /, **parts: object) -> FormatError:
    """The error for a file that cannot be read at all: a sentence, or the template of one with its parts."""
    return FormatError([Problem(field, say(message, **parts) if parts else message)], filename)


def check_table(filename: str, rows: int, columns: int) -> None:
    """Raises when a table of this size is beyond the limits."""
    most = in_force()
    if rows > most.rows:
        raise refusal(
            filename,
            "has {rows} rows; at most {limit} can be read, so average or split it",
            "table",
            rows=rows,
            limit=most.rows,
        )
    if columns > most.columns:
        raise refusal(
            filename, "has {columns} columns; at most {limit} can be read", "table", columns=columns, limit=most.columns
        )
    if rows * columns > most.cells:
        parts = {"rows": rows, "columns": columns, "cells": most.cells}
        text = say(
            "has {rows} rows × {columns} columns; at most {cells} cells can be read, so average or split it", **parts
        )
        raise refusal(filename, text, "table")
