"""The table of all benchmarks as it stands in its file: what is measured anew takes the place of what stood there."""

import ast
import os
import platform
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

BENCHMARKS = {
    "U1": "u1_start", "U2": "u2_uploads", "U4": "u4_pages", "U6": "u6_logs", "U8": "u8_sensors", "U9": "u9_verify",
    "P1": "p1_calibrate", "P2": "p2_fleet", "P3": "p3_orientations", "P4": "p4_diagnose", "P8": "p8_recompute",
    "P10": "p10_startup", "P11": "p11_history", "P12": "p12_files", "soak": "soak", "rivals": "rivals",
}  # fmt: skip
"""Beginning of a row's id → the file that measures it."""
ALSO = {"U3": "U2", "U5": "P8", "U7": "U1", "U10": "U4", "P4h": "P4"}
"""Rows that are measured with another benchmark."""
FELT = re.compile(r"U\d+")
"""Ids of what a user feels."""
HEAD = """# Benchmarks

Written by `make bench`; `make bench ONLY="U2 P8"` measures these anew and leaves the others.

## What a user feels

Machines differ by a factor of three, so that times are also in **m**, the time of `python -c "import numpy, scipy"`
on the same machine in the same minute. Both are by the clock, or the processor's where a row says so.

| id | what | measured | in m | target | reached |
| --- | --- | --- | --- | --- | --- |
"""
ENGINE = """
## The engine

A ratio is the peer's figure over ours, or a limit's: both in one run on one machine, medians taken in turn. Times are
the processor's, so that other programs on the machine do not count, but where a row says that they are by the clock.

| id | figure | ours | peer or limit | its figure | ratio | target | reached |
| --- | --- | --- | --- | --- | --- | --- | --- |
"""
RUNS = """
## When it was measured

| rows | on | seconds | end | machine |
| --- | --- | --- | --- | --- |
"""
RUN = re.compile(r"^\| (\w+) \| \d{4}-.*\|$")
"""A line of the second table."""


@dataclass
class Results:
    """Rows by their id, and by benchmark the line that says when it was measured."""

    file: Path
    rows: dict[str, str] = field(default_factory=dict)
    runs: dict[str, str] = field(default_factory=dict)

    @classmethod
    def read(cls, file: Path) -> "Results":
        """Reads the rows of the file; none where there is no file."""
        found = cls(file)
        for line in file.read_text("utf-8").splitlines() if file.exists() else []:
            if run := RUN.match(line):
                found.runs[run[1]] = line
            elif line.startswith("| ") and benchmark_of(line):
                found.rows[id_of(line)] = line
        return found

    def put(self, row: str) -> str:
        """A row that was measured now, in the place of the one of the same id; returns this."""
        id = id_of(row)
        self.rows[id] = row
        self.write()
        return id

    def ended(self, key: str, measured: set[str], seconds: float, end: str) -> None:
        """A benchmark is over; where it came to its end, what it did not measure any more is no row of it."""
        if end == "whole":
            old = [id for id, line in self.rows.items() if benchmark_of(line) == key and id not in measured]
            for id in old:
                del self.rows[id]
        today = datetime.now(UTC).date().isoformat()
        self.runs[key] = f"| {key} | {today} | {seconds:.0f} | {end} | {machine()} |"
        self.write()

    def write(self) -> None:
        """The whole file, benchmarks in their order, what a user feels first."""
        runs = "".join(f"{self.runs[key]}\n" for key in BENCHMARKS if key in self.runs)
        parts = (HEAD, *self._part(is_felt=True), ENGINE, *self._part(is_felt=False), RUNS, runs)
        unfinished = self.file.with_suffix(".part")
        unfinished.write_text("".join(parts), "utf-8")
        unfinished.replace(self.file)

    def _part(self, *, is_felt: bool) -> Iterator[str]:
        """The rows of one table, then what explains those of its benchmarks."""
        own = sorted((id for id in self.rows if bool(FELT.match(id)) is is_felt), key=place_of)
        yield from (f"{self.rows[id]}\n" for id in own)
        keys = {benchmark_of(line) for line in self.rows.values()}
        yield from (note_of(key) for key in BENCHMARKS if key in keys and bool(FELT.match(key)) is is_felt)


def place_of(id: str) -> int:
    """Sort key of a row in its table; rows of one place keep their order."""
    found = FELT.match(id)
    return int(found[0][1:]) if found else list(BENCHMARKS).index(benchmark_of(f"| {id} | "))


def id_of(line: str) -> str:
    """The id that a row begins with."""
    return line.split(" | ", 1)[0].removeprefix("| ")


def benchmark_of(line: str) -> str:
    """Key of a row's benchmark; empty for a line that is no row."""
    key = re.split(r"[, ]", id_of(line))[0]
    known = ALSO.get(key, key)
    return known if known in BENCHMARKS else ""


def note_of(key: str) -> str:
    """The explanation of a benchmark's rows: its file's NOTE, read without running the file."""
    source = Path(__file__).with_name(f"{BENCHMARKS[key]}.py").read_text("utf-8")
    for node in ast.parse(source).body:
        if isinstance(node, ast.Assign) and [ast.unparse(target) for target in node.targets] == ["NOTE"]:
            return str(ast.literal_eval(node.value))
    return ""


def machine() -> str:
    """The facts that a time depends on."""
    packages = ", ".join(f"{name} {version(name)}" for name in ("numpy", "scipy"))
    threads = os.environ.get("OPENBLAS_NUM_THREADS", "default")
    return (
        f"{platform.system()} {platform.machine()}, {processor()}, {os.cpu_count()} cores, "
        f"Python {platform.python_version()}, {packages}, BLAS threads: {threads}"
    )


def processor() -> str:
    """The processor's name where the system tells it."""
    facts = Path("/proc/cpuinfo")
    lines = facts.read_text().splitlines() if facts.exists() else []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or "unknown processor"
