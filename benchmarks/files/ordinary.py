"""Cost of the process apart for an ordinary file: one session as JSON, which is read in place, as XLSX and as
Parquet.
"""

import json
import time
from io import BytesIO

import polars as pl

from benchmarks.files.heavy import as_xlsx, log
from service.ingest import read_upload

CELLS = 24 * 7
"""Cells of a session of averaged positions."""
TIMES = 30


def ordinary() -> dict[str, bytes]:
    """Format → the file."""
    head, columns = log(CELLS * 10)
    buffer = BytesIO()
    pl.DataFrame(columns).write_parquet(buffer, metadata={"imu-session": json.dumps(head)})
    table = {name: column.tolist() for name, column in columns.items()}
    return {
        "JSON": json.dumps(head | {"table": table}).encode(),
        "XLSX": as_xlsx(CELLS * 10),
        "Parquet": buffer.getvalue(),
    }


def milliseconds() -> dict[str, float]:
    """Format → median time to read one."""
    return {name: _median(content) for name, content in ordinary().items()}


def _median(content: bytes) -> float:
    read_upload(content, "file")
    times = []
    for _ in range(TIMES):
        began = time.perf_counter()
        read_upload(content, "file")
        times.append(time.perf_counter() - began)
    return 1000 * sorted(times)[TIMES // 2]
