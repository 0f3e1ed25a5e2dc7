"""MATLAB files up to version 7: one variable a column, text as a char matrix; the metadata in `imu_session`.

Structures, cells and objects may declare any size with a few bytes, so they are not read at all.
"""

import zlib
from io import BytesIO
from typing import Literal

import numpy as np
from scipy.io import loadmat, whosmat
from scipy.io.matlab import MatReadError, matfile_version

from estimator.errors import FormatError
from service.ingest.limits import MOST_TEXT, check_cells, refusal
from service.ingest.metadata import with_metadata

MAGIC = b"MATLAB "
"""First bytes of every MAT file."""
VERSION = b"MATLAB 5.0 MAT-file"
"""First bytes of one that is read: level 5, not the HDF5 of version 7.3."""
VARIABLE = "imu_session"
"""The structure that holds the session."""
HEADER = 128
"""Bytes before the first variable (MAT-File Format, level 5)."""
COMPRESSED = 15
"""Type of an element that holds another one deflated (miCOMPRESSED)."""
NUMERIC = ("double", "single", "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64")
"""Classes whose values are numbers."""
DAMAGED = (
    OSError,
    ValueError,
    TypeError,
    LookupError,
    ArithmeticError,
    MemoryError,  # a size written over
    zlib.error,
    MatReadError,
)
"""What scipy raises on files cut off or written over at various places."""


def read_mat(content: bytes, filename: str) -> dict[str, object]:
    """The document that a MAT file holds."""
    if not content.startswith(VERSION):
        raise refusal(filename, "is of a MATLAB version that is not read; save it with save(…, '-v7')")
    if _unpacked_size(content) > MOST_TEXT:
        raise refusal(filename, f"unpacks to more than {MOST_TEXT // 1024**2} MiB; average or split the log")
    names = _variables(content, filename)
    try:
        variables = loadmat(of_version_5(content), variable_names=names)  # type: ignore[arg-type]  # stubs lack file-likes
        columns = {name: _cells(variables[name]) for name in names}
    except DAMAGED as error:
        raise _damaged(filename) from error
    metadata = columns.pop(VARIABLE, None)
    if not isinstance(metadata, list) or len(metadata) != 1 or metadata[0] is None:
        raise refusal(filename, f"has no text variable {VARIABLE}; put the session's JSON without its table there")
    return with_metadata(metadata[0], columns, filename)


def of_version_5(content: bytes) -> BytesIO:
    """A MAT file for scipy; ValueError where its header says another version, such as 7.3, which is HDF5."""
    file = BytesIO(content)
    if matfile_version(file)[0] != 1:  # type: ignore[arg-type]  # stubs lack file-likes
        raise ValueError("the header says another version than 5")
    return file


def _variables(content: bytes, filename: str) -> list[str]:
    """The names of all variables, once each is known to be of a plain kind and of bearable size."""
    try:
        declared = whosmat(of_version_5(content), chars_as_strings=False)  # type: ignore[arg-type]  # stubs lack file-likes
    except DAMAGED as error:
        raise _damaged(filename) from error
    names = [name for name, _, _ in declared]
    for name, shape, kind in declared:
        if kind not in (*NUMERIC, "char") or names.count(name) > 1:
            raise refusal(filename, f"is of kind {kind}; give each column once, as numbers or as a char matrix", name)
        if len(shape) != 2 or (kind != "char" and min(shape) > 1):
            raise refusal(filename, f"has the shape {shape}; a column is a vector, or a char matrix", name)
        check_cells(filename, shape[0], shape[1])
    check_cells(filename, max((max(shape) for name, shape, _ in declared if name != VARIABLE), default=0), len(names))
    return names


def _cells(value: object) -> object:
    array = np.atleast_1d(np.asarray(value))
    if array.dtype.kind in "fiu":
        return array.ravel()
    return [text.strip() or None for text in array.astype(str).ravel().tolist()]


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


def _damaged(filename: str) -> FormatError:
    return refusal(filename, "is damaged or not a readable MAT file; write it again")
