"""Reads one MAT file from standard input, answers with a line of JSON, and behind it the plain variables as NPZ.

A program of its own, because scipy's reader falls over on some damaged files. It imports nothing of this project, so
that it starts quickly. Structures, cells and objects may declare any size with a few bytes: they are named, never read.
"""

import json
import sys
import zlib
from io import BytesIO
from math import prod
from typing import Any

import numpy as np
from scipy.io import loadmat, whosmat
from scipy.io.matlab import MatReadError, matfile_version

if sys.platform != "win32":
    import resource

LEVEL_5 = 1
"""How scipy numbers MAT files up to version 7."""
MEMORY = 4 * 1024**3
"""Bytes of address space, of which a whole file takes a small part."""
PLAIN = ("char", "single", "double", *(f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)))
"""Classes whose values are text or numbers."""
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


def read(content: bytes, most_cells: int) -> tuple[dict[str, Any], list[Any]]:
    """Name, shape and class of all variables; the plain ones as arrays in their order, where they are not too many."""
    if matfile_version(BytesIO(content))[0] != LEVEL_5:  # type: ignore[arg-type]  # stubs lack file-likes
        raise ValueError("the header says another version than 5")
    declared = whosmat(BytesIO(content), chars_as_strings=False)  # type: ignore[arg-type]  # stubs lack file-likes
    plain = [name for name, _, kind in declared if kind in PLAIN]
    cells = sum(prod(shape) for name, shape, _ in declared if name in plain)
    if not plain or cells > most_cells:
        return {"declared": declared}, []
    found = loadmat(BytesIO(content), variable_names=plain)  # type: ignore[arg-type]  # stubs lack file-likes
    return {"declared": declared}, [np.asarray(found[name]) for name in plain]


def main() -> None:
    """Answer for the file on standard input; the argument is the most cells."""
    if sys.platform != "win32":
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    try:
        answer, arrays = read(sys.stdin.buffer.read(), int(sys.argv[1]))
    except DAMAGED:
        answer, arrays = {"refused": ("file", "is damaged or not a readable MAT file; write it again")}, []
    sys.stdout.buffer.write(json.dumps(answer).encode() + b"\n")
    packed = BytesIO()
    np.savez(packed, *arrays, allow_pickle=False)
    sys.stdout.buffer.write(packed.getvalue())


if __name__ == "__main__":
    main()
