"""Opening the files of a recording: every fault becomes a `FormatError` that names the file and the place in it."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from estimator.errors import FormatError, Problem
from estimator.wording import counted


def refuse(path: Path, field: str, message: str, row: int | None = None) -> FormatError:
    """The error to raise for one fault of a file."""
    return FormatError([Problem(field, message, row)], source=path.name)


def read_bytes(path: Path) -> bytes:
    """The bytes of a file."""
    try:
        return path.read_bytes()
    except OSError as fault:
        raise refuse(path, "file", f"cannot be read: {fault.strerror}") from fault


def read_numbers(path: Path, width: int) -> NDArray[np.float64]:
    """Lines of ``width`` numbers separated by blanks: (rows, width)."""
    text = read_bytes(path).decode("ascii", errors="replace")
    if not text.strip():
        raise refuse(path, "text", f"is empty; must hold {width} numbers a line")
    try:
        values = np.loadtxt(text.splitlines(), ndmin=2, comments=None)
    except ValueError as fault:
        raise refuse(path, "text", f"{fault}; every line must hold {width} numbers separated by blanks") from fault
    if values.shape[1] != width:
        told = f"{counted(len(values), 'line')} of {counted(values.shape[1], 'number')}"
        raise refuse(path, "text", f"holds {told}; must hold {width} a line")
    unusable = np.flatnonzero(~np.isfinite(values).all(axis=1))
    if len(unusable):
        raise refuse(path, "text", "holds a value that is not a finite number", row=int(unusable[0]) + 1)
    return values


def expect_count(paths: list[Path], count: int, what: str) -> None:
    """Refuse any other number of files."""
    if len(paths) != count:
        raise FormatError([Problem("files", f"{len(paths)} given; name {what}")])


def one_containing(paths: list[Path], part: str) -> Path:
    """The one file whose name contains ``part``."""
    found = [path for path in paths if part in path.name.lower()]
    if len(found) != 1:
        raise FormatError([Problem("files", f"{len(found)} of the names contain {part!r}; exactly one must")])
    return found[0]
