"""HDF5: group `readings` with one dataset a column; the metadata as JSON in the root's text attribute `imu-session`.

Only plain datasets inside the file are followed: links to other files, and data kept in them, are refused. The library
hangs or crashes on some damaged files, so it is only used in a separate process.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO

import h5py
import numpy as np

from service.ingest.metadata import KEY, with_metadata
from service.kit.limits import check_table, refusal

GROUP = "readings"
"""Group with one dataset a column."""
MOST_LABELS = 200_000
"""Texts of one column: each is a Python object in memory."""
PLAIN = "must be a one-dimensional dataset of numbers or text inside the file"
DAMAGED = (OSError, RuntimeError, TypeError, LookupError, ArithmeticError, UnicodeError, AttributeError)
"""Raised by h5py for truncated or overwritten files; also ValueError, which SessionError is too."""


def read_hdf5(content: bytes, filename: str) -> dict[str, object]:
    """The document that an HDF5 file holds."""
    with _damage_refused(filename), h5py.File(BytesIO(content), "r") as file:
        metadata = file.attrs.get(KEY)
        if not isinstance(metadata, str):
            raise refusal(
                filename, "has no text attribute {key}; put the session's JSON without its table there", key=KEY
            )
        columns = _columns(file, filename)
    return with_metadata(metadata, columns, filename)


def has_metadata(content: bytes, filename: str) -> bool:
    """Whether the file has a session's metadata."""
    with _damage_refused(filename), h5py.File(BytesIO(content), "r") as file:
        return KEY in file.attrs


def table_of(content: bytes, filename: str) -> dict[str, object]:
    """The columns of the group, or else of the root."""
    with _damage_refused(filename), h5py.File(BytesIO(content), "r") as file:
        return _columns(file, filename) if GROUP in file else _datasets(file, filename)


def _columns(file: h5py.File, filename: str) -> dict[str, object]:
    if not isinstance(file.get(GROUP, getlink=True), h5py.HardLink) or not isinstance(file[GROUP], h5py.Group):
        raise refusal(filename, "has no group {group}; put one dataset per column there", group=GROUP)
    return _datasets(file[GROUP], filename)


def _datasets(group: h5py.Group, filename: str) -> dict[str, object]:
    check_table(filename, 0, len(group))
    datasets = {name: _dataset(group, name, filename) for name in group}
    check_table(filename, max((column.size for column in datasets.values()), default=0), len(datasets))
    return {name: _values(name, column, filename) for name, column in datasets.items()}


@contextmanager
def _damage_refused(filename: str) -> Iterator[None]:
    try:
        yield
    except (*DAMAGED, ValueError) as error:
        if hasattr(error, "problems"):
            raise
        raise refusal(filename, "is damaged or not a readable HDF5 file; write it again") from error


def _dataset(group: h5py.Group, name: str, filename: str) -> h5py.Dataset:
    """The column of this name; only plain datasets."""
    if not isinstance(group.get(name, getlink=True), h5py.HardLink):
        raise refusal(filename, "is a link; {advice}", name, advice=PLAIN)
    item = group[name]
    if not isinstance(item, h5py.Dataset) or item.ndim != 1 or item.is_virtual or item.external:
        raise refusal(filename, "is not a plain column; {advice}", name, advice=PLAIN)
    return item


def _values(name: str, column: h5py.Dataset, filename: str) -> object:
    if column.dtype.kind in "fiu":
        return np.asarray(column[()])
    if h5py.check_string_dtype(column.dtype) is None:
        raise refusal(filename, "is of type {dtype}; {advice}", name, dtype=column.dtype, advice=PLAIN)
    if column.size > MOST_LABELS:
        raise refusal(
            filename,
            "has {size} texts; at most {most_labels}, so use whole numbers",
            name,
            size=column.size,
            most_labels=MOST_LABELS,
        )
    return [column[row].decode("utf-8") or None for row in range(column.size)]
