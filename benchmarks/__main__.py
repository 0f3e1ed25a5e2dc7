"""Run the benchmarks and write the table: ``python -m benchmarks``, or some of them: ``--only U2 P8``.

Each runs in a process of its own, and every row is written as soon as it is measured: what fails, hangs or is ended
loses none of the rows before it.
"""

import argparse
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import IO

from rich.console import Console

from benchmarks.results import BENCHMARKS, Results

RESULTS = Path(__file__).with_name("RESULTS.md")
LONGEST = 1200.0
"""Seconds after which a benchmark is ended: twice what the longest takes on two cores that do nothing else."""
PATIENCE = 30.0
"""Seconds in which one that is ended stops what it has started."""
BETWEEN = 0.5
"""Seconds between two looks at what was measured."""


def main() -> int:
    """Exit code 1 where a benchmark failed."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--only", nargs="+", choices=list(BENCHMARKS), default=list(BENCHMARKS), metavar="P1")
    parser.add_argument("--out", type=Path, default=RESULTS, help="the table's file")
    options = parser.parse_args()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    results, console = Results.read(options.out), Console()
    ends = [measured(key, results, console) for key in options.only]
    return int(any(end != "whole" for end in ends))


def measured(key: str, results: Results, console: Console) -> str:
    """Runs one benchmark, prints its rows and returns how it ended."""
    console.rule(f"{key}: benchmarks/{BENCHMARKS[key]}.py")
    began, end, seen = time.monotonic(), "interrupted", set[str]()
    with tempfile.NamedTemporaryFile("r", prefix="imu-bench-", encoding="utf-8") as rows:
        process = subprocess.Popen([sys.executable, "-m", "benchmarks.one", BENCHMARKS[key], rows.name])
        try:
            for row in until_it_ends(process, rows):
                seen.add(results.put(row))
                console.print(row, markup=False, highlight=False, soft_wrap=True)
            end = {None: "ended as too long", 0: "whole"}.get(process.poll(), "failed")
        finally:
            stop(process)
            results.ended(key, seen, time.monotonic() - began, end)
    console.print(f"{key}: {end}, {time.monotonic() - began:.0f} s")
    return end


def until_it_ends(process: subprocess.Popen[bytes], rows: IO[str]) -> Iterator[str]:
    """Rows as they are measured, until the process ends or has taken too long."""
    end, going = time.monotonic() + LONGEST, True
    while going:
        going = process.poll() is None and time.monotonic() < end
        yield from (line.rstrip("\n") for line in rows.readlines())
        time.sleep(BETWEEN * going)


def stop(process: subprocess.Popen[bytes]) -> None:
    """Lets it stop what it has started; nothing where it has ended."""
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
    try:
        process.wait(PATIENCE)
    except subprocess.TimeoutExpired:
        process.kill()


if __name__ == "__main__":
    sys.exit(main())
