"""U6: a raw log of a gigabyte to its averaged positions, by the clock, and the peak memory of the process that reads.

What is measured stands in `benchmarks/files/long.py`.
"""

import tempfile
from collections.abc import Iterator
from pathlib import Path

from benchmarks.figures import Felt
from benchmarks.files.long import long_logs

MEBIBYTE = 1024**2 / 1e6
"""MB."""


def run() -> Iterator[Felt]:
    """CSV and Parquet, time and memory."""
    with tempfile.TemporaryDirectory(prefix="imu-u6-") as folder:
        for log in long_logs(Path(folder)):
            work = f"a {log.kind} log of {log.size / 1e9:.2f} GB taken in"
            yield Felt(f"U6, {log.kind}", work, log.seconds, 80)
            peak = "peak memory of its reader over idle"
            yield Felt(f"U6, {log.kind}, memory", peak, log.memory * MEBIBYTE, 100, "MB")
