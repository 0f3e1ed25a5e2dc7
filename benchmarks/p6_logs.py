"""P6: a raw log of a gigabyte to its averaged positions, against a bare polars scan with a group-by mean.

What is measured, and the peer, stand in `benchmarks/files/long.py`; so does the memory: the peak of the reading process
over idle. Times are by the clock: polars works on all cores.
"""

import tempfile
from collections.abc import Iterator
from pathlib import Path

from benchmarks.figures import Figure
from benchmarks.files.long import long_logs

MEBIBYTE = 1024**2 / 1e6
"""MB."""

NOTE = """
P6 keeps its memory and misses its time, by the clock. A CSV is parsed twice, once for its labels: where a rest is
trimmed is not known before its end. Of Parquet hardly anything is parsed, so that there the checks of every cell, the
sums of every rest and what hangs together within it take nearly all of the time, and the peer does none of them.
"""


def run() -> Iterator[Figure]:
    """CSV and Parquet, time and memory."""
    with tempfile.TemporaryDirectory(prefix="imu-p6-") as folder:
        for log in long_logs(Path(folder)):
            work = f"{log.kind} of {log.size / 1e9:.2f} GB to averaged positions"
            peer = "polars scan with a group-by mean"
            yield Figure(f"P6, {log.kind}", f"{work}, by the clock", peer, log.seconds, log.peer, "at least 2/3")
            memory = log.memory * MEBIBYTE
            yield Figure(f"P6, {log.kind}, memory", f"{work}, peak memory over idle", "limit", memory, 500, "≥ 1", "MB")
