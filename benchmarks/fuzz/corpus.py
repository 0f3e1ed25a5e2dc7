"""Small valid files of every format, which the fuzzer starts from."""

import json
from io import BytesIO

import h5py
import polars as pl
import xlsxwriter
from scipy.io import savemat

from benchmarks.files.heavy import Columns, log
from benchmarks.files.hostile import HOSTILE

CELLS = 24 * 7
SMALL = 100_000
"""Bytes of a hostile file that is worth mutating."""


def corpus() -> dict[str, bytes]:
    """Name → file."""
    head, columns = log(CELLS, 4)
    head.pop("sample_rate_hz")
    found = {
        "json": json.dumps(head | {"table": {name: column.tolist() for name, column in columns.items()}}).encode(),
        "csv": f"# {json.dumps(head)}\n{pl.DataFrame(columns).write_csv()}".encode(),
        "parquet": _parquet(json.dumps(head), columns),
        "hdf5": _hdf5(json.dumps(head), columns),
        "mat": _mat(json.dumps(head), columns),
        "xlsx": _xlsx(head, columns),
    }
    small = {name: one.make() for name, one in ((one.name, one) for one in HOSTILE) if "endless" not in name}
    return found | {name: content for name, content in small.items() if len(content) < SMALL}


def _parquet(head: str, columns: Columns) -> bytes:
    buffer = BytesIO()
    pl.DataFrame(columns).write_parquet(buffer, metadata={"imu-session": head})
    return buffer.getvalue()


def _hdf5(head: str, columns: Columns) -> bytes:
    buffer = BytesIO()
    with h5py.File(buffer, "w") as file:
        file.attrs["imu-session"] = head
        for name, column in columns.items():
            file[f"readings/{name}"] = column
    return buffer.getvalue()


def _mat(head: str, columns: Columns) -> bytes:
    buffer = BytesIO()
    savemat(buffer, {"imu_session": head, **columns}, do_compression=True, oned_as="column")
    return buffer.getvalue()


def _xlsx(head: dict[str, object], columns: Columns) -> bytes:
    buffer = BytesIO()
    with xlsxwriter.Workbook(buffer) as book:
        session, readings = book.add_worksheet("session"), book.add_worksheet("readings")
        for j, (key, value) in enumerate(head.items()):
            session.write_row(j, 0, [key, json.dumps(value) if isinstance(value, list | dict) else value])
        for k, (name, column) in enumerate(columns.items()):
            readings.write_column(0, k, [name, *column.tolist()])
    return buffer.getvalue()
