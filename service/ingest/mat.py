"""MATLAB files up to version 7: one variable a column, text as a char matrix; the metadata in `imu_session`."""

import zlib
from io import BytesIO
from pathlib import Path
from typing import Any, Literal

import numpy as np

from service.ingest.apart import read_apart
from service.ingest.limits import MOST_CELLS, MOST_TEXT, refusal
from service.ingest.metadata import with_metadata

MAGIC = b"MATLAB "
"""First bytes of every MAT file."""
VERSION = b"MATLAB 5.0 MAT-file"
"""First bytes of one that is read: level 5, not the HDF5 of version 7.3."""
VARIABLE = "imu_session"
"""The variable that holds the session."""
HEADER = 128
"""Bytes before the first variable (MAT-File Format, level 5)."""
COMPRESSED = 15
"""Type of an element that holds another one deflated (miCOMPRESSED)."""
NUMERIC = ("double", "single", "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64")
"""Classes whose values are numbers."""
CHILD = Path(__file__).with_name("mat_child.py")
"""Run by its path, so that it imports nothing of the service."""


def read_mat(content: bytes, filename: str) -> dict[str, object]:
    """The document that a MAT file holds."""
    if not content.startswith(VERSION):
        raise refusal(filename, "is of a MATLAB version that is not read; save it with save(…, '-v7')")
    columns = variables(content, filename, most_rows=1)
    metadata = columns.pop(VARIABLE, None)
    text = None if metadata is None else metadata.ravel().tolist()
    if text is None or metadata is None or metadata.dtype.kind != "U" or len(text) != 1 or not text[0].strip():
        raise refusal(filename, f"has no text variable {VARIABLE}; put the session's JSON without its table there")
    return with_metadata(text[0].strip(), {name: _cells(column) for name, column in columns.items()}, filename)


def variables(content: bytes, filename: str, *, most_rows: int) -> dict[str, np.ndarray[Any, Any]]:
    """All variables (rows, columns) by name, in the file's own units.

    FormatError where one is neither text nor numbers, or has more than so many rows and columns.
    """
    if _unpacked_size(content) > MOST_TEXT:
        raise refusal(filename, f"unpacks to more than {MOST_TEXT // 1024**2} MiB; average or split the log")
    answer, arrays = read_apart(CHILD, content, filename, str(MOST_CELLS))
    names, cells = [name for name, _, _ in answer["declared"]], 0
    for name, shape, kind in answer["declared"]:
        if kind not in (*NUMERIC, "char") or names.count(name) > 1:
            raise refusal(filename, f"is of kind {kind}; give each column once, as numbers or as a char matrix", name)
        if len(shape) != 2 or (kind != "char" and min(shape) > most_rows):
            raise refusal(filename, f"has the shape {tuple(shape)}; a column is a vector, or a char matrix", name)
        cells += shape[0] * shape[1]
    if cells > MOST_CELLS:
        raise refusal(filename, f"has {cells} cells; at most {MOST_CELLS} can be read, so average or split it", "table")
    with np.load(BytesIO(arrays), allow_pickle=False) as found:
        return {name: found[f"arr_{place}"] for place, name in enumerate(names)}


def _cells(column: np.ndarray[Any, Any]) -> object:
    if column.dtype.kind in "fiu":
        return column.ravel()
    return [text.strip() or None for text in column.ravel().tolist()]


def _unpacked_size(content: bytes) -> int:
    """Bytes of all compressed variables once unpacked, counted no further than the limit."""
    order: Literal["little", "big"] = "little" if content[126:128] == b"IM" else "big"
    at, total = HEADER, 0
    while at + 8 <= len(content) and total <= MOST_TEXT:
        kind = int.from_bytes(content[at : at + 4], order)
        size = int.from_bytes(content[at + 4 : at + 8], order)
        if kind == COMPRESSED:
            total += _inflated(content[at + 8 : at + 8 + size])
        at += 8 + size
    return total


def _inflated(packed: bytes) -> int:
    unpack, total = zlib.decompressobj(), 0
    try:
        while packed and total <= MOST_TEXT:
            total += len(unpack.decompress(packed, 1 << 20))
            packed = unpack.unconsumed_tail
    except zlib.error:
        return total
    return total
