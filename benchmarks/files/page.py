"""The page of the costs of files."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import timedelta

from benchmarks.details import in_full
from benchmarks.files.long import LongLog, table
from benchmarks.files.service import Cost
from estimator.long_logs.average import MOST_RESTS
from service.ingest import LONG
from service.ingest.apart import PACE
from service.ingest.layout.sampling import HEAD, PLACES
from service.jobs.records import KEPT as KEPT_MADE
from service.kit.limits import LARGE, SMALL
from service.storage.aside import MOST, MOST_BYTES, RETENTION
from service.storage.landing import IN_MEMORY
from service.storage.waiting import JOB_DELAY

RETRY = "503 with `Retry-After`"
LIMITS = {
    "whole": ("bytes of an upload, but for raw logs", "413"),
    "log": ("bytes of a raw log, as text or Parquet", "413"),
    "attached": ("bytes of a file that is attached", "413"),
    "rows": ("rows of a table", "422"),
    "columns": ("columns of a table", "422"),
    "cells": ("cells of a table, rows × columns", "422"),
    "log_cells": ("cells of a raw log that is averaged while it is scanned", "422"),
    "nesting": ("lists and objects within each other in a JSON file", "422"),
    "unpacked": ("bytes that the compressed parts of a file unpack to", "422"),
    "seconds": ("seconds of computing that reading a file takes; by the clock thrice", "422"),
    "memory": ("bytes of memory that reading a file takes in its process", "422"),
    "at_once": ("binary and large files that are read at once; others wait, then are rejected", RETRY),
    "in_flight": ("large uploads that are received or worked on at once; others are rejected", RETRY),
}
"""Unit of each limit, and the answer beyond it."""
MEBIBYTE = 1024**2


@dataclass(frozen=True)
class Row:
    """One file, or several at once."""

    name: str
    size: int
    cost: Cost


def page(rows: Sequence[Row], ordinary: dict[str, float], long: Sequence[LongLog]) -> str:
    """The whole page."""
    worst = max(row.cost.memory for row in rows if "at once" not in row.name)
    wait = max(row.cost.wait for row in rows)
    return f"""# Limits of uploaded files

Made by `python -m benchmarks.files`; edit `benchmarks/files/page.py`, not this page.

No uploaded file may end, freeze or bloat the service:

* **Sizes are counted** before anything is built: cells of a workbook, rows and columns of CSV, nesting of JSON.
* **A separate process reads.** XLSX, HDF5, MAT, Parquet, logs and text of more than {LONG // MEBIBYTE} MiB are read
  by a process whose memory, CPU time and wall-clock time the kernel limits. It cannot write files, has no settings or
  passwords, and returns numbers and text, never objects.
* **Nothing large is held in memory.** An upload of more than {IN_MEMORY // 1024} KiB is written to disk and
  hashed as it arrives.
* **Concurrency is limited**, one place fewer for one account or address; some more uploads wait up to ten seconds,
  others are rejected with 503 and `Retry-After`.

An ordinary file of 240 rows is read in {_times(ordinary)}
(median); JSON of that size is read in the service.

## Limits

{_limits()}

A cell takes about 60 bytes of memory. Reading may take a second more for every
{PACE // 10**6} MB of a file.

{_long(long)}
{_places()}
## Measured

Hostile files and the heaviest allowed ones against a running service, memory of all its processes.

Worst single file: {worst:.0f} MiB over idle. Longest wait for `/healthz`: {wait:.2f} s.

{in_full(_table(rows))}

## Fuzzing

Tests damage valid files of every format at random, `python -m benchmarks.fuzz` guided by the code that it reaches: each
is read, or refused with a reason. `make fuzz-numbers` puts extreme numbers into every field
([bounds](../session-file.md#which-numbers-are-taken)) and every other call: [what became of
them](../../benchmarks/fuzz/NUMBERS.md).
"""


def _times(ordinary: dict[str, float]) -> str:
    return ", ".join(f"{time:.0f} ms as {name}" for name, time in ordinary.items())


def _long(long: Sequence[LongLog]) -> str:
    return f"""## Long raw logs

A raw log (`sample_rate_hz`) of more cells than that, as CSV or Parquet, is averaged to its positions while it is
scanned (`estimator/long_logs`), in constant memory and with the same result as a log in one
piece. Up to {MOST_RESTS:,} positions. As JSON, XLSX, HDF5 or MAT a log is read
whole, and so is a Parquet file of custom layout. To propose how a text of custom layout is read, its first
{HEAD // MEBIBYTE} MiB and {PLACES} later places are looked at.

Medians of three; memory of the reading process over idle.

{table(list(long))}
"""


def _places() -> str:
    hour = timedelta(hours=1)
    return f"""## Where files lie

On one disk, in the folder `files` of the data folder:

| folder in it | what | how long | in a backup |
| --- | --- | --- | --- |
| `00` to `ff` | uploads and attached files, under their hash | for good | yes |
| `arriving` | uploads beyond {IN_MEMORY // 1024} KiB while they arrive | until the request ends | no |
| `waiting` | acknowledged large files that a [job](../how-to/long-work.md#a-large-log) is to read | until the job \
ends: then stored under its hash, or removed | yes, so that after a restore the job continues |
| `aside` | tables of custom layout of more than {IN_MEMORY // 1024} KiB, while their sender confirms on a page \
how they are read; only that account continues with them | until stored, at most {RETENTION // hour} hours after the \
page was last shown; {MOST} of an account and {MOST_BYTES // MEBIBYTE // 1024} GiB of all, the oldest are removed \
first | no: send it again |
| `made` | reports that jobs made, under the job's number | {KEPT_MADE.days} days | no: ask for it again |

What a killed service left is removed hourly; of `waiting` what no open job names, {JOB_DELAY // hour} hour after it \
came.
"""


def _limits() -> str:
    head = """`IMU_HEALTH_MACHINE` says how large the machine is: `small` is for 2 GB of memory, `large` for 8 GB.

| at most | `small` | `large` | answer |
| --- | --- | --- | --- |
"""
    return head + "\n".join(
        f"| {what} | {getattr(SMALL, name):,} | {getattr(LARGE, name):,} | {answer} |"
        for name, (what, answer) in LIMITS.items()
    )


def _table(rows: Sequence[Row]) -> str:
    head = (
        "| file | size, kB | answer | seconds | memory over idle, MiB | longest /healthz, s |\n" + "| --- " * 6 + "|\n"
    )
    return head + "\n".join(
        f"| {row.name} | {row.size / 1000:,.1f} | {', '.join(map(str, row.cost.statuses))} | {row.cost.seconds:.1f} "
        f"| {row.cost.memory:.0f} | {row.cost.wait:.2f} |"
        for row in rows
    )
