"""Reads one HDF5 file from standard input and answers on standard output with its metadata and columns as JSON.

A program of its own, because the HDF5 library loops for ever or falls over on some damaged files. It imports nothing
of this project, so that it starts quickly. Only plain datasets inside the file are followed: links to other files, and
data kept in them, are refused.
"""

import json
import sys
from io import BytesIO
from typing import Any

import h5py

if sys.platform != "win32":
    import resource

GROUP = "readings"
"""That holds one dataset a column."""
MOST_LABELS = 200_000
"""Texts of one column: each is an object of its own in memory."""
MEMORY = 4 * 1024**3
"""Bytes of address space, of which a whole file takes a small part."""
PLAIN = "must be a one-dimensional dataset of numbers or text inside the file"
DAMAGED = (OSError, RuntimeError, ValueError, TypeError, LookupError, ArithmeticError, MemoryError)


class UnusableError(Exception):
    """A fault that its sender can mend: where it is, and what it is."""


def limit_memory() -> None:
    """A file that claims the whole memory gets none; where the platform cannot limit it, the time limit remains."""
    if sys.platform != "win32":
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))


def read(content: bytes, key: str, most_cells: int) -> dict[str, Any]:
    """The metadata and the columns of the file."""
    with h5py.File(BytesIO(content), "r") as file:
        metadata = file.attrs.get(key)
        if not isinstance(metadata, str):
            raise UnusableError("file", f"has no text attribute {key}; put the session's JSON without its table there")
        if not isinstance(file.get(GROUP, getlink=True), h5py.HardLink) or not isinstance(file[GROUP], h5py.Group):
            raise UnusableError("file", f"has no group {GROUP}; put one dataset per column there")
        datasets = {name: dataset(file[GROUP], name) for name in file[GROUP]}
        cells = sum(column.size for column in datasets.values())
        if cells > most_cells:
            raise UnusableError("table", f"has {cells} cells; at most {most_cells} can be read, so average or split it")
        return {"metadata": metadata, "columns": {name: values(name, column) for name, column in datasets.items()}}


def dataset(group: h5py.Group, name: str) -> h5py.Dataset:
    """The column of this name, when it is a plain one."""
    if not isinstance(group.get(name, getlink=True), h5py.HardLink):
        raise UnusableError(name, f"is a link; {PLAIN}")
    item = group[name]
    if not isinstance(item, h5py.Dataset) or item.ndim != 1 or item.is_virtual or item.external:
        raise UnusableError(name, f"is not a plain column; {PLAIN}")
    return item


def values(name: str, column: h5py.Dataset) -> list[Any]:
    """The cells; None where a number is NaN or a text is empty."""
    if column.dtype.kind in "fiu":
        return [None if cell != cell else cell for cell in column[()].tolist()]
    if h5py.check_string_dtype(column.dtype) is None:
        raise UnusableError(name, f"is of type {column.dtype}; {PLAIN}")
    if column.size > MOST_LABELS:
        raise UnusableError(name, f"has {column.size} texts; at most {MOST_LABELS}, so use whole numbers")
    return [column[row].decode("utf-8") or None for row in range(column.size)]


def main() -> None:
    """Answer for the file on standard input; the arguments are the metadata's key and the most cells."""
    key, most_cells = sys.argv[1:]
    limit_memory()
    try:
        answer = read(sys.stdin.buffer.read(), key, int(most_cells))
    except UnusableError as error:
        answer = {"refused": error.args}
    except DAMAGED:
        answer = {"refused": ("file", "is damaged or not a readable HDF5 file; write it again")}
    json.dump(answer, sys.stdout)


if __name__ == "__main__":
    main()
