"""A raw log of a gigabyte → its averaged positions."""

import json
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from threading import Event, Thread

import polars as pl
import psutil

from benchmarks.files.heavy import SENSORS, log
from benchmarks.files.service import BETWEEN, memory
from service.ingest import apart, read_upload

ROWS = 15_000_000
"""Rows of the log: as CSV of 7 digits they take about a gigabyte."""
ROUNDS = 3
"""Rounds, of which the median is reported."""


@dataclass(frozen=True)
class LongLog:
    """Time and memory of one format."""

    kind: str
    size: int
    seconds: float
    memory: float
    """Peak of the reading process over the one it is a fork of, MiB."""


def long_logs(folder: Path, rows: int = ROWS, rounds: int = ROUNDS) -> Iterator[LongLog]:
    """CSV and Parquet."""
    for kind, write in (("csv", write_csv), ("parquet", write_parquet)):
        path = folder / f"log.{kind}"
        write(path, rows)
        read_upload(path, "warm")
        taken, peaks = [], [0.0]
        for _ in range(rounds):
            with Watched(peaks):
                began = time.perf_counter()
                read_upload(path, "log")
                taken.append(time.perf_counter() - began)
        yield LongLog(kind, path.stat().st_size, median(taken), max(peaks))
        path.unlink()


class Watched:
    """Looks at the memory of the process that reads, while something is read."""

    def __init__(self, peaks: list[float]) -> None:
        self._peaks, self._done = peaks, Event()
        (self._server,) = (one for one in psutil.Process().children() if apart.SERVER in one.cmdline())

    def __enter__(self) -> None:
        self._idle = memory(self._server)
        self._watcher = Thread(target=self._look)
        self._watcher.start()

    def _look(self) -> None:
        while not self._done.wait(BETWEEN):
            self._peaks.append(memory(self._server) - self._idle)

    def __exit__(self, *_: object) -> None:
        self._done.set()
        self._watcher.join()


def frame_of(rows: int) -> tuple[str, pl.DataFrame]:
    """Metadata and table of a log of so many rows."""
    head, columns = log(rows * (SENSORS + 1), 7, "LONG-1")
    return json.dumps(head), pl.DataFrame(columns)


def write_csv(path: Path, rows: int) -> None:
    head, frame = frame_of(rows)
    with path.open("wb") as file:
        file.write(f"# {head}\n".encode())
        frame.write_csv(file)


def write_parquet(path: Path, rows: int) -> None:
    head, frame = frame_of(rows)
    frame.write_parquet(path, metadata={"imu-session": head}, compression="uncompressed")


def table(found: list[LongLog]) -> str:
    """Markdown."""
    lines = [f"| {one.kind} | {one.size / 1e6:,.0f} | {one.seconds:.1f} | {one.memory:.0f} |" for one in found]
    return "| format | size, MB | seconds | memory, MiB |\n| --- | --- | --- | --- |\n" + "\n".join(lines)
