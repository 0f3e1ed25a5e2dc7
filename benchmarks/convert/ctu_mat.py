"""Czech Technical University (Šipoš, Roháč, Šimánek): means of 49 still orientations of one triad, in g."""

from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.convert.contract import Converter, Document
from benchmarks.convert.documents import columns, session, triad
from benchmarks.convert.files import expect_count, read_bytes, refuse
from estimator.applied_vector import STANDARD_GRAVITY
from service.ingest.apart import read_apart

BYTE_ORDER = slice(126, 128)
"""Bytes of a MAT file's header that state its byte order."""
FILES = "the MAT file that holds `ACC_meas`, three rows of orientation means in g"


def array(path: Path) -> np.ndarray[Any, Any] | None:
    """(3, orientations) means in g that the file holds as ``ACC_meas``; None when it holds nothing of that name."""
    content = read_bytes(path)
    if content[BYTE_ORDER] not in (b"IM", b"MI"):
        raise refuse(path, "file", "is no MAT file of version 5")
    found: np.ndarray[Any, Any] | None = read_apart("mat-matrices", content, path.name).get("ACC_meas")
    return found


def convert(paths: list[Path]) -> list[tuple[str, Document]]:
    """One MAT file → one averaged session without standard errors."""
    expect_count(paths, 1, FILES)
    path = paths[0]
    values = array(path)
    if values is None or values.ndim != 2 or values.shape[0] != 3 or values.dtype.kind not in "fiu":
        raise refuse(path, "ACC_meas", "must be an array of three rows of numbers")
    means = values.T.astype(np.float64)
    unusable = np.flatnonzero(~np.isfinite(means).all(axis=1))
    if len(unusable):
        raise refuse(path, "ACC_meas", "holds a value that is not a finite number", row=int(unusable[0]) + 1)
    sensors = triad("A", 1 / STANDARD_GRAVITY, "g")
    notes = "CTU Prague recording, orientation means of 1000 samples in g; the local g is not published"
    document = session("ctu-triad", sensors, columns(sensors, means), gravity=STANDARD_GRAVITY, notes=notes)
    return [("ctu-orientations.json", document)]


CTU_MAT = Converter(
    name="ctu-mat",
    description="Means of one triad in still orientations on three great circles.",
    files=FILES,
    convert=convert,
)
