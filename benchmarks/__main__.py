"""Run every benchmark and write the table: ``python -m benchmarks``."""

import os
import platform
from importlib.metadata import version
from pathlib import Path

from rich.console import Console

from benchmarks import (
    p1_calibrate,
    p2_fleet,
    p3_orientations,
    p4_diagnose,
    p5_uploads,
    p7_fleet,
    p8_recompute,
    p10_startup,
    p11_history,
)
from benchmarks.figures import Figure

BENCHMARKS = (
    p1_calibrate,
    p2_fleet,
    p3_orientations,
    p4_diagnose,
    p5_uploads,
    p7_fleet,
    p8_recompute,
    p10_startup,
    p11_history,
)
RESULTS = Path(__file__).with_name("RESULTS.md")

HEAD = """# Benchmarks

Written by `make bench`. Each ratio is taken in one run on one machine: the peer's median time over ours, taken in turn.
Times are the processor's, so that other programs on the machine do not count.

Machine: {machine}

| id | figure | time | peer | peer's time | ratio | target |
| --- | --- | --- | --- | --- | --- | --- |
"""


def machine() -> str:
    """The facts that a time depends on."""
    packages = ", ".join(f"{name} {version(name)}" for name in ("numpy", "scipy"))
    threads = os.environ.get("OPENBLAS_NUM_THREADS", "default")
    return (
        f"{platform.system()} {platform.machine()}, {processor()}, {os.cpu_count()} cores, "
        f"Python {platform.python_version()}, {packages}, BLAS threads: {threads}."
    )


def processor() -> str:
    """The processor's name where the system tells it."""
    facts = Path("/proc/cpuinfo")
    lines = facts.read_text().splitlines() if facts.exists() else []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or "unknown processor"


def row(f: Figure) -> str:
    """One line of the table."""
    times = f"{1e3 * f.ours:.3g} ms | {f.peer} | {1e3 * f.theirs:.3g} ms"
    return f"| {f.id} | {f.work} | {times} | {f.ratio:.3g} | {f.target} |\n"


def notes() -> str:
    """What explains the rows, benchmark by benchmark."""
    return "".join(getattr(benchmark, "NOTE", "") for benchmark in BENCHMARKS)


def main() -> None:
    """Run, show, write."""
    console = Console()
    rows = []
    for benchmark in BENCHMARKS:
        for figure in benchmark.run():
            rows.append(row(figure))
            console.print(f"{figure.id}: {figure.ratio:.3g} × {figure.peer} (target {figure.target})")
    RESULTS.write_text(HEAD.format(machine=machine()) + "".join(rows) + notes())


if __name__ == "__main__":
    main()
