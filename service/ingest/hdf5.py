"""HDF5: group `readings` with one dataset a column; the metadata as JSON in the root's text attribute `imu-session`.

Only plain datasets inside the file are followed: links to other files, and data kept in them, are refused, and passed
over in a table of one's own, which may be of matrices and groups too, as MATLAB writes them from version 7.3 on. The
library hangs or crashes on some damaged files, so it is only used in a separate process.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from typing import Any

import h5py
import numpy as np

from service.ingest.metadata import KEY, with_metadata
from service.kit.limits import check_table, refusal

GROUP = "readings"
"""Group with one dataset a column."""
DEEPEST = 4
"""Groups within each other that are followed."""
WIDEST = 100
"""Columns of one matrix that are read."""
INTEGERS = tuple(f"{sign}int{bits}".encode() for sign in ("", "u") for bits in (8, 16, 32, 64))
"""Classes of MATLAB's whole numbers."""
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
    """The columns of the group, or else of the whole file: matrices, and groups within each other, column by column."""
    with _damage_refused(filename), h5py.File(BytesIO(content), "r") as file:
        if GROUP in file:
            return _columns(file, filename)
        found = list(_found(file, (), filename))
        check_table(filename, max((max(one.shape, default=0) for _, one in found), default=0), len(found))
        check_table(filename, sum(one.size for _, one in found), 1)
        is_shared = len({path[0] for path, _ in found}) == 1 and min(len(path) for path, _ in found) > 1
        columns: dict[str, object] = {}
        for path, one in found:
            columns |= _split(" ".join(path[is_shared:]), one, filename)
        return columns


def _found(group: h5py.Group, path: tuple[str, ...], filename: str) -> Iterator[tuple[tuple[str, ...], h5py.Dataset]]:
    """Datasets of one or two dimensions with the names that lead to them; no text of MATLAB, and nothing empty."""
    check_table(filename, 0, len(group))
    for name in group:
        if name.startswith("#") or not isinstance(group.get(name, getlink=True), h5py.HardLink):
            continue
        item = group[name]
        if isinstance(item, h5py.Group) and len(path) < DEEPEST:
            yield from _found(item, (*path, name), filename)
        elif _is_table(item):
            yield (*path, name), item


def _is_table(item: object) -> bool:
    if not isinstance(item, h5py.Dataset) or item.ndim not in (1, 2) or item.is_virtual or item.external:
        return False
    kind = item.attrs.get("MATLAB_class", b"double")
    is_number = item.dtype.kind in "fiu" and kind in (b"double", b"single", *INTEGERS)
    return bool(item.size and (is_number or item.dtype.names or h5py.check_string_dtype(item.dtype)))


def _split(name: str, item: h5py.Dataset, filename: str) -> dict[str, Any]:
    """Columns of one dataset: a matrix's longer side are its rows; of records, their fields."""
    if item.dtype.names:
        records = item[()].ravel()
        return {f"{name} {key}": records[key] for key in item.dtype.names if records[key].dtype.kind in "fiu"}
    if item.dtype.kind not in "fiu":
        return {name: _values(name, item, filename)} if item.ndim == 1 else {}
    return columns_of(name, np.asarray(item[()]))


def columns_of(name: str, values: np.ndarray[Any, Any]) -> dict[str, Any]:
    """The columns of a matrix, whose longer side are its rows; of a vector, or of text, itself."""
    if values.dtype.kind == "U" or values.ndim < 2 or min(values.shape) == 1:
        return {name: values.ravel()}
    columns = values if values.shape[0] < values.shape[1] else values.T
    return {f"{name} {k}": column for k, column in enumerate(columns[:WIDEST], start=1)}


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
