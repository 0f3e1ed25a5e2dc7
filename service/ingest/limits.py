"""What an upload may hold and cost, so that a small file cannot become a big one in memory.

Like the limits that an operating system sets a process, these are one set a process: `create_app` takes them from the
settings, every other program from the environment.
"""

from dataclasses import dataclass

from estimator.errors import FormatError, Problem
from estimator.reading import Extent
from service.settings import Settings


@dataclass(frozen=True)
class Limits:
    """Of one file. Every one can be set: see `service.settings`."""

    rows: int
    columns: int
    cells: int
    """Rows × columns of a table."""
    log_cells: int
    """The same of a raw log that is averaged while it is scanned."""
    whole: int
    """Bytes of a file that is read whole."""
    nesting: int
    """Lists and objects of JSON within each other."""
    unpacked: int
    """Bytes, of an archive's or a file's compressed parts."""
    seconds: int
    """Of computing; on a busy machine reading may take `WAITING` times as long."""
    memory: int
    """Bytes, of the process that reads the file."""
    at_once: int
    """Files that are read apart at the same time."""

    @property
    def extent(self) -> Extent:
        """What the estimator's reader is told."""
        return Extent(rows=self.rows, columns=self.columns, cells=self.cells, nesting=self.nesting)


class _InForce:
    """The one set of this process."""

    limits: Limits | None = None


def limits_of(settings: Settings) -> Limits:
    """The part of the settings that concerns files."""
    return Limits(
        rows=settings.max_rows,
        columns=settings.max_columns,
        cells=settings.max_cells,
        log_cells=settings.max_log_cells,
        whole=settings.max_upload_bytes,
        nesting=settings.max_nesting,
        unpacked=settings.max_unpacked_bytes,
        seconds=settings.max_read_seconds,
        memory=settings.max_read_bytes,
        at_once=settings.reads_at_once,
    )


def in_force() -> Limits:
    """The limits of this process."""
    if _InForce.limits is None:
        _InForce.limits = limits_of(Settings())
    return _InForce.limits


def use(limits: Limits) -> None:
    """Sets them for this process."""
    _InForce.limits = limits


def refusal(filename: str, message: str, field: str = "file") -> FormatError:
    """The error for a file that cannot be read at all."""
    return FormatError([Problem(field, message)], filename)


def check_table(filename: str, rows: int, columns: int) -> None:
    """Raises when a table of this size is beyond the limits."""
    most = in_force()
    if rows > most.rows:
        raise refusal(filename, f"has {rows} rows; at most {most.rows} can be read, so average or split it", "table")
    if columns > most.columns:
        raise refusal(filename, f"has {columns} columns; at most {most.columns} can be read", "table")
    if rows * columns > most.cells:
        text = f"has {rows} rows × {columns} columns; at most {most.cells} cells can be read, so average or split it"
        raise refusal(filename, text, "table")
