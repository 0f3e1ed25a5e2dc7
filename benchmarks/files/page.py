"""The page of what files cost."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import timedelta

from benchmarks.files.long import LongLog, table
from benchmarks.files.service import Cost
from estimator.long_logs.average import MOST_RESTS
from service.ingest import LONG
from service.ingest.apart import PACE
from service.jobs.records import KEPT as KEPT_MADE
from service.kit.limits import LARGE, SMALL
from service.storage.aside import KEPT, MOST, MOST_BYTES
from service.storage.landing import IN_MEMORY
from service.storage.waiting import UNASKED
from service.uploads.layout.form import MOST_CARRIED

RETRY = "503 with `Retry-After`"
LIMITS = {
    "whole": ("bytes of an upload, but for raw logs", "413"),
    "log": ("bytes of a raw log, as CSV or Parquet", "413"),
    "attached": ("bytes of a file that is attached", "413"),
    "rows": ("rows of a table", "422"),
    "columns": ("columns of a table", "422"),
    "cells": ("cells of a table, rows × columns", "422"),
    "log_cells": ("cells of a raw log that is averaged while it is scanned", "422"),
    "nesting": ("lists and objects within each other in a JSON file", "422"),
    "unpacked": ("bytes that the compressed parts of a file unpack to", "422"),
    "seconds": ("seconds of computing that reading a file takes; by the clock thrice", "422"),
    "memory": ("bytes of memory that reading a file takes in its process", "422"),
    "at_once": ("binary and large files that are read at once; others wait, then are asked back", RETRY),
    "in_flight": ("large uploads that are received or worked on at once; others are asked back", RETRY),
}
"""What each is of, and the answer beyond it."""
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
    return f"""# What a file may cost

Made by `python -m benchmarks.files`; edit `benchmarks/files/page.py`, not this page.

No file that somebody uploads may end, freeze or bloat the service. Five things see to that:

* **Nothing is believed.** The extent of a table is counted before anything is built from it: the cells of a workbook
  one by one, wherever its sheets lie; rows and columns of CSV; lists, nesting and commas of JSON.
* **Another process reads.** XLSX, HDF5, MAT, Parquet, logs and text of more than {LONG // MEBIBYTE} MiB, are read by a
  process of their own. Before it sees a byte the kernel bounds its memory, its computing time and its time by the
  clock. It cannot write files, knows no setting and no password, and gives back numbers and text, never objects
  (no pickle). When it is ended, the upload is answered 422 with what to do, and the service goes on.
  The commands read such files the same way, recordings of any length for `imu-health parity` among them; there the
  answer is a line and exit code 2.
* **Nothing long is held.** An upload of more than {IN_MEMORY // 1024} KiB goes to disk as it comes, hashed and
  counted on the way; the file that is kept is that one, synced and renamed. The reading process opens it there. What
  was not kept is removed with the request, or by the hourly look.
* **Few at once.** So many files are read at the same time, one place fewer for one account or address; some more wait
  up to ten seconds; the others are answered 503 with `Retry-After`.
* **The bytes stay.** What is stored is the upload, unchanged, under its hash.

The process is a fork of one that has the readers loaded. An ordinary file of 240 rows is read in {_times(ordinary)}
(median), fork included; JSON of that size is read in place.

## Limits

{_limits()}

A cell takes about 60 bytes of memory. Reading may take a second more for every
{PACE // 10**6} MB of a file.

{_long(long)}
{_places()}
## Measured

Against a running service: peak memory over idle of the service, its readers and what diagnoses together (proportional
set size, so that shared pages count once), and the longest that `/healthz` took to answer meanwhile; the seconds are
those of the answer. Hostile files come first, all made by code in `benchmarks/files/hostile.py`; then the heaviest
files that are allowed, watched until nothing is left to do for them.

Worst single file: {worst:.0f} MiB over idle. Longest wait for `/healthz`: {wait:.2f} s.

| file | size, kB | answer | seconds | memory over idle, MiB | longest /healthz, s |
| --- | --- | --- | --- | --- | --- |
{_table(rows)}

How long things take depends on the machine and on what else it does; memory does not.

## Fuzzing

`tests/service/ingest/test_hostile.py` damages valid files of every format at random: each is read, or refused with a
reason. `python -m benchmarks.fuzz` does the same guided by the code that it reaches, for as long as it is let.
`make fuzz-numbers` puts extreme numbers into every field ([bounds](../session-file.md#which-numbers-are-taken)).
"""


def _times(ordinary: dict[str, float]) -> str:
    return ", ".join(f"{time:.0f} ms as {name}" for name, time in ordinary.items())


def _long(long: Sequence[LongLog]) -> str:
    return f"""## Long raw logs

A raw log (`sample_rate_hz`) of more cells than that, as CSV or Parquet, is averaged to its positions while it is
scanned (`estimator/long_logs`): first for its labels, or for where the block stands still, then for the sums of every
rest. Of a rest only sums are kept, so that memory does not grow with the log; the positions are those that a log in
one piece gives, standard errors included. Up to {MOST_RESTS:,} positions. As JSON, XLSX, HDF5 or MAT a log is read
whole.

Beside the peer, which is polars alone with a scan and a group-by mean of the same file, its start not counted: medians
of three in turn on the same machine; the memory is the reading process's over idle.

{table(list(long))}

A CSV is parsed twice, once for its labels: where a rest is trimmed is not known before its end. Of Parquet hardly
anything is parsed, so that there the checks of every cell and the sums take nearly all of the time: the wish of 1.5
times a bare scan is met for neither.
"""


def _places() -> str:
    hour = timedelta(hours=1)
    return f"""## Where files lie

All of them lie on one disk, in the folder `files` of the data folder:

| folder in it | what | how long | in a backup |
| --- | --- | --- | --- |
| `00` to `ff` | uploads and attached files, under their hash | for good | yes |
| `arriving` | what comes just now, beyond {IN_MEMORY // 1024} KiB | until its request ends | no |
| `waiting` | large files that were acknowledged and that a [job](../how-to/long-work.md#a-large-log) is to read, each \
under a random name | until the job ends: then stored under its hash, or gone | yes, under its hash, so that after a \
restore the job goes on |
| `aside` | tables of a layout of their own of more than {MOST_CARRIED // MEBIBYTE} MiB, while their sender says on a \
page how they are read; under a hash of the account and one of the bytes | until stored, at most {KEPT // hour} hours \
after that page was last shown; {MOST} of an account and {MOST_BYTES // MEBIBYTE // 1024} GiB of all, the oldest give \
way | no: send it again |
| `made` | reports that jobs made, under the job's number | {KEPT_MADE.days} days | no: ask for it again |

What waits or is set aside is given out by no address. Only the account that set a table aside goes on with it, and it
is stored when that confirms. What a service that was killed left behind goes with the hourly look: what is half
written, what was set aside too long ago, and of `waiting` what no open job names, {UNASKED // hour} hour after it came.
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
    return "\n".join(
        f"| {row.name} | {row.size / 1000:,.1f} | {', '.join(map(str, row.cost.statuses))} | {row.cost.seconds:.1f} "
        f"| {row.cost.memory:.0f} | {row.cost.wait:.2f} |"
        for row in rows
    )
