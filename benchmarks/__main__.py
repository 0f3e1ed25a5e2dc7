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

NOTE = """
P1 misses its targets by a factor of two to three. One session is too small for arrays: six sensors, five parameters
each. Solving it takes some 0.37 ms on a quiet machine: of that the Newton step takes 0.22 ms, where the bare one of the
floor takes 0.15; the closed form takes 0.06, the check of the noise and what is observable 0.06. The report, a result
for every sensor, takes another 0.13 ms. These are some eight hundred calls of Python and numpy of less than a
microsecond each: without any report, and with all but the Newton step at half its time, ours would just reach twice the
floor. What the schedule alone decides is remembered already. The peer of the same likelihood evaluates the readings a
hundred times, each in a tenth of a millisecond, for its numeric Jacobian. Sensor by sensor it is quick for the same
reason as ours: five parameters from 48 rows. What one session cannot show, many can: P2 is the same code on many
sessions in one call, where a result is built when it is read.

P2 reaches its target against the solves, and misses that against the loop: read one by one, the results take more than
half of the time, and in the loop no longer.

P3 reaches its target against the same likelihood, by little where orientations are fewest: of twelve, a calibration is
one search of four linearisations, in which an orientation costs next to nothing beside the calls. Starts that
tell the same of the ellipsoid are searched once. Against the published descent the target is reached only where it
needs hundreds of passes: a pass takes it half a millisecond to 1.5, so that after 50 to 150 of them a hundredth of its
time is a fraction of a millisecond, less than one linearisation with its report. The descent fits less, a functional of
triples without directions or covariance.

P4 misses its target by a factor of three. The peer refits once per cause and sensor; ours scores every place and shape
of the catalogue, states a detection limit for each cause and measures the gain on positions held out. By profile a
quarter of its time makes and whitens the thousand signatures and their inner products, a fifth scores them in some ten
rounds, a sixth looks for structure in place of names and for smooth courses, a tenth predicts positions held out: sixty
thousand calls in all, of which none stands out. A hundredth of the peer's time leaves room for a third of them.

P4h misses its target of twice the time: it takes 2.2 to 2.6 times as long, and three and a half times where the
earlier sessions are new to the process. An earlier session's own fit and its statistics depend on nothing else and are
remembered by its content; the service keeps the statistics in its store. But every earlier session is fitted anew near
this one and turned into its frame, a place that depends on both: that takes a third of what history adds, all sessions
in one call. Half of it makes and scores every signature three times, as lasting, as new, and with the sensor's change
left open, and works out what each earlier session absorbed of it. The rest is the pool of all sessions.

P5 is taken by the clock, and misses its target by a factor of ten. Parsing and checking a session, its calibration, the
verdict of every parameter with its covariance, flags, the fleet's line and the audit trail are some 0.06 s of Python
on one core, within one transaction; the peer stores one row. Eight clients are as quick as two, but two services are
no quicker than one on two cores, because the processes that make diagnoses share them.

P7 is measured with 20 sessions a unit instead of a hundred, because a fleet of 10,000 units with all rows of a hundred
is 22 GB; no page of the fleet reads older sessions, and a unit's own are read by an index. Nothing is worked
out over the fleet in a request. Most pages miss twice the time of their statements: what is left is making
rows into records, and records into pages. Lists have 50 to 100 entries whatever the fleet, the calendar a thousand
events, the paper 41 charts at fifty milliseconds each. Other programs shared the machine: pages that read the very same
rows of either fleet differ by a fifth. What does grow is the first page of units, by some milliseconds in which
PostgreSQL sorts the units of one condition, and the workbook by its sheet of all units.

P10 misses its second target by its libraries. The peer imports numpy and of scipy only the name. A calibration needs
scipy's special functions, for probabilities and coverage factors, a third of the time: their import loads all of numpy
too, its Fortran wrapper among it. Arguments are read by Typer, which reads them by pydantic, another quarter, and rich
draws the table. These alone, imported and left, take more than three times as long as the peer. Own modules are a
fifteenth, reading and calibrating a hundredth.

P11 reaches its target: what grows with a history is reading the unit's own sessions in short, one row each, and
counting them by stand.
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


def main() -> None:
    """Run, show, write."""
    console = Console()
    rows = []
    for benchmark in BENCHMARKS:
        for figure in benchmark.run():
            rows.append(row(figure))
            console.print(f"{figure.id}: {figure.ratio:.3g} × {figure.peer} (target {figure.target})")
    RESULTS.write_text(HEAD.format(machine=machine()) + "".join(rows) + NOTE)


if __name__ == "__main__":
    main()
