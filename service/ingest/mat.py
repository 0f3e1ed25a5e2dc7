"""MATLAB files up to version 7: one variable a column, text as a char matrix; the metadata in `imu_session`.

A table of one's own may also be matrices, whose longer side are its rows, and single structures of them. Cells, objects
and arrays of structures may declare any size in a few bytes: they are never read, and of a session file named in a
problem. The library crashes on some damaged files, so it is only used in a separate process.
"""

import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from math import prod
from typing import Any, Literal

import numpy as np
from scipy.io import loadmat, whosmat
from scipy.io.matlab import MatReadError, matfile_version

from estimator.errors import FormatError
from service.ingest import hdf5
from service.ingest.metadata import with_metadata
from service.kit.limits import check_table, in_force, refusal

VERSION = b"MATLAB 5.0 MAT-file"
"""First bytes of a file that is read: level 5, not the HDF5 of version 7.3."""
LEVEL_5 = 1
"""Scipy's number for MAT files up to version 7."""
VARIABLE = "imu_session"
"""Variable with the session's metadata."""
HEADER = 128
"""Bytes before the first variable (MAT-File Format, level 5)."""
COMPRESSED = 15
"""Type of an element with another one deflated inside (miCOMPRESSED)."""
NUMERIC = ("double", "single", "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64")
"""Classes whose values are numbers."""
PLAIN = ("char", *NUMERIC)
"""Classes whose values are text or numbers."""
STRUCTURE = "struct"
DEEPEST = 4
"""Structures within each other that are followed."""
DAMAGED = (OSError, ValueError, TypeError, LookupError, ArithmeticError, zlib.error, MatReadError)
"""Raised by scipy for truncated or overwritten files."""

MOST_TEXT = 1_000_000
"""Characters of text beside the table's cells: the metadata, and the labels of its rows."""

Declared = tuple[str, tuple[int, ...], str]
"""Name, shape and class of a variable."""


def read_mat(content: bytes, filename: str) -> dict[str, object]:
    """The document that a MAT file holds."""
    columns = variables(content, filename, most_rows=1)
    metadata = columns.pop(VARIABLE, None)
    text = None if metadata is None else metadata.ravel().tolist()
    if text is None or metadata is None or metadata.dtype.kind != "U" or len(text) != 1 or not text[0].strip():
        raise refusal(
            filename,
            "has no text variable {variable}; put the session's JSON without its table there",
            variable=VARIABLE,
        )
    return with_metadata(text[0].strip(), {name: cells(column) for name, column in columns.items()}, filename)


def has_metadata(content: bytes, filename: str) -> bool:
    """Whether the file has a session's metadata."""
    if not content.startswith(VERSION):
        return False
    with _damage_refused(filename):
        return any(name == VARIABLE for name, _, _ in _declared(content))


def table_of(content: bytes, filename: str) -> dict[str, Any]:
    """The columns of all variables: of matrices, and of the fields of structures."""
    if not content.startswith(VERSION):
        return hdf5.table_of(content, filename)
    _check_unpacked(content, filename)
    with _damage_refused(filename):
        declared = _declared(content)
        read = [name for name, shape, kind in declared if kind in PLAIN or (kind == STRUCTURE and prod(shape) == 1)]
        if not read:
            kinds = ", ".join(dict.fromkeys(kind for _, _, kind in declared))
            raise refusal(
                filename,
                "holds nothing but {kinds}; save numbers, or what table2struct(…, 'ToScalar', true) gives",
                kinds=kinds or "nothing",
            )
        _check_cells([one for one in declared if one[0] in read], filename)
        values = loadmat(BytesIO(content), variable_names=read)  # type: ignore[arg-type]  # stubs lack file-likes
        leaves = [leaf for name in read for leaf in _leaves((name,), np.asarray(values[name]))]
    shared = len(leaves[0][0]) > 1 and len({path[0] for path, _ in leaves}) == 1 if leaves else False
    columns = {
        heading: cells(column)
        for path, leaf in leaves
        for heading, column in hdf5.columns_of(" ".join(path[shared:]), leaf).items()
    }
    check_table(filename, max(map(len, columns.values()), default=0), len(columns))
    return columns


def _leaves(path: tuple[str, ...], value: np.ndarray[Any, Any]) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Arrays of numbers or text within a value, with the names that lead there."""
    if value.dtype.kind in "fiuU" and value.ndim <= 2:
        yield path, value
    if value.dtype.names and value.size == 1 and len(path) <= DEEPEST:
        for name in value.dtype.names:
            yield from _leaves((*path, name), np.asarray(value[name].item()))


def variables(content: bytes, filename: str, *, most_rows: int) -> dict[str, np.ndarray[Any, Any]]:
    """All variables (rows, columns) by name, in the file's own units.

    FormatError for one that is neither text nor numbers, or has more than ``most_rows`` rows and columns.
    """
    if not content.startswith(VERSION):
        raise refusal(filename, "is of a MATLAB version that is not read; save it with save(…, '-v7')")
    _check_unpacked(content, filename)
    with _damage_refused(filename):
        declared = _declared(content)
        _check_declared(declared, filename, most_rows)
        values = loadmat(BytesIO(content))  # type: ignore[arg-type]  # stubs lack file-likes
        return {name: np.asarray(values[name]) for name, _, _ in declared}


def _check_unpacked(content: bytes, filename: str) -> None:
    limit = in_force().unpacked
    if _unpacked_size(content, limit) > limit:
        raise refusal(filename, "unpacks to more than {limit} MiB; average or split the log", limit=limit // 1024**2)


@contextmanager
def _damage_refused(filename: str) -> Iterator[None]:
    try:
        yield
    except DAMAGED as error:
        if isinstance(error, FormatError):
            raise
        raise refusal(filename, "is damaged or not a readable MAT file; write it again") from error


def _declared(content: bytes) -> list[Declared]:
    if matfile_version(BytesIO(content))[0] != LEVEL_5:  # type: ignore[arg-type]  # stubs lack file-likes
        raise ValueError("the header says another version than 5")
    variables_ = whosmat(BytesIO(content), chars_as_strings=False)  # type: ignore[arg-type]  # stubs lack file-likes
    return [(name, shape, kind) for name, shape, kind in variables_]


def _check_declared(declared: list[Declared], filename: str, most_rows: int) -> None:
    """Raises for a variable that is not a column, and for too many cells in all."""
    names = [name for name, _, _ in declared]
    for name, shape, kind in declared:
        if kind not in PLAIN or names.count(name) > 1:
            raise refusal(
                filename, "is of kind {kind}; give each column once, as numbers or as a char matrix", name, kind=kind
            )
        if len(shape) != 2 or (kind != "char" and min(shape) > most_rows):
            raise refusal(
                filename, "has the shape {shape}; a column is a vector, or a char matrix", name, shape=tuple(shape)
            )
    _check_cells(declared, filename)


def _check_cells(declared: list[Declared], filename: str) -> None:
    check_table(filename, 0, len(declared))
    cell_count, limit = sum(prod(shape) for _, shape, _ in declared), in_force().cells
    if cell_count > limit + MOST_TEXT:
        raise refusal(
            filename,
            "has {cells} cells; at most {limit} can be read, so average or split it",
            "table",
            cells=cell_count,
            limit=limit,
        )


def cells(column: np.ndarray[Any, Any]) -> Any:
    """Numbers, or texts with None where they are empty."""
    if column.dtype.kind in "fiu":
        return column.ravel()
    return [text.strip() or None for text in column.ravel().tolist()]


def _unpacked_size(content: bytes, most: int) -> int:
    """Bytes of all compressed variables once unpacked; counting stops above the limit."""
    order: Literal["little", "big"] = "little" if content[126:128] == b"IM" else "big"
    offset, total = HEADER, 0
    while offset + 8 <= len(content) and total <= most:
        kind = int.from_bytes(content[offset : offset + 4], order)
        size = int.from_bytes(content[offset + 4 : offset + 8], order)
        if kind == COMPRESSED:
            total += _inflated(content[offset + 8 : offset + 8 + size], most)
        offset += 8 + size
    return total


def _inflated(packed: bytes, most: int) -> int:
    unpack, total = zlib.decompressobj(), 0
    try:
        while packed and total <= most:
            total += len(unpack.decompress(packed, 1 << 20))
            packed = unpack.unconsumed_tail
    except zlib.error:
        return total
    return total
