"""The heaviest files that are allowed: raw logs with as many cells as the limits let through, in every format."""

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from io import BytesIO
from typing import Any

import h5py
import numpy as np
import polars as pl
import xlsxwriter
from numpy.typing import NDArray
from scipy.io import savemat

from benchmarks.files.hostile import csv
from service.kit.limits import SMALL

SENSORS, ORIENTATIONS = 6, 24
GRAVITY, SCALE, NOISE = 9.81, 0.12, 1e-5
"""m/s²; V per m/s²; V."""
MOST_BYTES = SMALL.whole
CELLS = SMALL.cells

Columns = dict[str, NDArray[Any]]


@dataclass(frozen=True)
class Heavy:
    """One file: its name, and what makes it."""

    name: str
    make: Callable[[], bytes]


def log(cells: int, digits: int | None = None, unit: str = "HEAVY-1") -> tuple[dict[str, Any], Columns]:
    """Metadata and columns of a log of a redundant block at rest in many orientations."""
    rng = np.random.default_rng(1)
    turn = 2 * np.pi * np.arange(SENSORS) / SENSORS
    axes = np.column_stack([np.cos(turn), np.full(SENSORS, 0.7), np.sin(turn)])
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    up = rng.normal(size=(ORIENTATIONS, 3))
    up /= np.linalg.norm(up, axis=1)[:, None]
    rows = cells // (SENSORS + 1)
    position = np.sort(np.arange(rows) % ORIENTATIONS)
    readings = SCALE * GRAVITY * (up @ axes.T)[position] + rng.normal(size=(rows, SENSORS)) * NOISE
    readings = readings if digits is None else readings.round(digits)
    head = {
        "format": "imu-session/1", "unit": unit, "block": "accelerometer", "programme": "arbitrary-orientations",
        "started_at": "2026-03-01T09:00:00Z", "site": {"gravity_m_s2": GRAVITY}, "sample_rate_hz": 100.0,
        "sensors": [
            {"name": f"A{k + 1}", "nominal_axis": axis.tolist(), "nominal_scale": SCALE, "reading_unit": "V"}
            for k, axis in enumerate(axes)
        ],
    }  # fmt: skip
    return head, {"position": position, **{f"A{k + 1}": readings[:, k] for k in range(SENSORS)}}


def as_json() -> bytes:
    """Text of 7 digits."""
    head, columns = log(CELLS, 7, "JSON-1")
    return json.dumps(head | {"table": {name: column.tolist() for name, column in columns.items()}}).encode()


def as_csv() -> bytes:
    """The log as CSV."""
    head, columns = log(CELLS, 7, "CSV-1")
    table = pl.DataFrame(columns).write_csv()
    return csv(table).replace(b"# " + csv("")[2 : csv("").index(b"\n")], b"# " + json.dumps(head).encode(), 1)


def as_parquet(unit: str = "PARQUET-1") -> bytes:
    """Uncompressed doubles."""
    head, columns = log(CELLS, unit=unit)
    buffer = BytesIO()
    pl.DataFrame(columns).write_parquet(buffer, metadata={"imu-session": json.dumps(head)}, compression="uncompressed")
    return buffer.getvalue()


def as_hdf5() -> bytes:
    """Uncompressed doubles."""
    head, columns = log(CELLS, unit="HDF5-1")
    buffer = BytesIO()
    with h5py.File(buffer, "w") as file:
        file.attrs["imu-session"] = json.dumps(head)
        for name, column in columns.items():
            file[f"readings/{name}"] = column
    return buffer.getvalue()


def as_mat() -> bytes:
    """Uncompressed doubles."""
    head, columns = log(CELLS, unit="MAT-1")
    buffer = BytesIO()
    savemat(buffer, {"imu_session": json.dumps(head), **columns}, oned_as="column")
    return buffer.getvalue()


def as_xlsx(cells: int = CELLS // 2) -> bytes:
    """Half of the cells: a workbook of more takes more memory than reading may."""
    head, columns = log(cells, 7, "XLSX-1")
    buffer = BytesIO()
    with xlsxwriter.Workbook(buffer, {"constant_memory": False}) as book:
        session, readings = book.add_worksheet("session"), book.add_worksheet("readings")
        pairs = [(key, value) for key, value in head.items() if key not in ("sensors", "site")]
        pairs += [("site.gravity_m_s2", GRAVITY)]
        pairs += [
            (f"sensors[{k + 1}].{key}", json.dumps(value) if isinstance(value, list) else value)
            for k, sensor in enumerate(head["sensors"])
            for key, value in sensor.items()
        ]
        for j, pair in enumerate(pairs):
            session.write_row(j, 0, pair)
        for k, (name, column) in enumerate(columns.items()):
            readings.write_column(0, k, [name, *column.tolist()])
    return buffer.getvalue()


HEAVY = (
    Heavy("json", as_json),
    Heavy("csv", as_csv),
    Heavy("parquet", as_parquet),
    Heavy("hdf5", as_hdf5),
    Heavy("mat", as_mat),
    Heavy("xlsx", as_xlsx),
)
"""One of each format."""
AT_ONCE = 4


def heaviest() -> Iterator[tuple[str, Callable[[], list[bytes]]]]:
    """Each alone, then several at once: a name, and what makes them."""
    for one in HEAVY:
        yield f"heaviest {one.name}", lambda make=one.make: [make()]  # type: ignore[misc]
    yield f"heaviest parquet, {AT_ONCE} at once", lambda: [as_parquet(f"U-{k}") for k in range(AT_ONCE)]
