"""MATLAB files up to version 7: one variable a column, text as a char matrix; the metadata in `imu_session`.

Structures, cells and objects may declare any size in a few bytes: they are named in a problem, never read. The library
crashes on some damaged files, so it is only used in a separate process.
"""

import zlib
from io import BytesIO
from math import prod
from typing import Any, Literal

import numpy as np
from scipy.io import loadmat, whosmat
from scipy.io.matlab import MatReadError, matfile_version

from estimator.errors import FormatError
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


def variables(content: bytes, filename: str, *, most_rows: int) -> dict[str, np.ndarray[Any, Any]]:
    """All variables (rows, columns) by name, in the file's own units.

    FormatError for one that is neither text nor numbers, or has more than ``most_rows`` rows and columns.
    """
    if not content.startswith(VERSION):
        raise refusal(filename, "is of a MATLAB version that is not read; save it with save(…, '-v7')")
    limit = in_force().unpacked
    if _unpacked_size(content, limit) > limit:
        raise refusal(filename, "unpacks to more than {limit} MiB; average or split the log", limit=limit // 1024**2)
    try:
        declared = _declared(content)
        _check_declared(declared, filename, most_rows)
        values = loadmat(BytesIO(content))  # type: ignore[arg-type]  # stubs lack file-likes
        return {name: np.asarray(values[name]) for name, _, _ in declared}
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
