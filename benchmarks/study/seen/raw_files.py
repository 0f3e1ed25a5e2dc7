"""``python -m benchmarks.study.seen.raw_files --n 400 --seed 1``: raw files with what loggers do, on five paths.

A block of three accelerometers and three gyros is held still by hand in many orientations. Its samples are written as a
session in JSON, as a long session in CSV that is averaged while it is scanned, as a table of one's own, as MAT and as
an MCAP log, each with one of sixteen faults of raw files or with none. What comes out is right by name (the fault is
corrected, left out or noted, and the numbers hold), refused with the way on, or silently wrong: numbers off by more
than three of their expanded uncertainties, with nothing said.
"""

import argparse
import tempfile
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from benchmarks.study.seen.raw_cases import FAULTS, FELT, NO_RATE, NOMINAL, PATHS, RATE, Case, world
from estimator.errors import SessionError
from estimator.programmes import calibrate
from estimator.session import CalibrationSession
from service.ingest.jobs import session as read
from service.kit import limits


@dataclass(frozen=True)
class DrawnFile:
    """One file and what came of it."""

    fault: str
    path: str
    outcome: str
    kinds: tuple[str, ...] = ()
    worst: float = np.nan
    """Largest difference from the truth, in its expanded uncertainty."""
    said: str = ""


def read_session(content: bytes, path: str) -> CalibrationSession:
    """Reads the session as the service does; a long log part by part."""
    if path != "long csv":
        found = read(content, path)
    else:
        usual = limits.in_force()
        limits.use(replace(usual, cells=20_000))
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "long.csv"
            file.write_bytes(content)
            try:
                found = read(file, path)
            finally:
                limits.use(usual)
    assert isinstance(found, CalibrationSession)
    return found


def worst_of(session: CalibrationSession, case: Case, path: str) -> float:
    """Largest difference of a bias or scale factor from the truth, in U; infinite where it is not known."""
    result, offs = calibrate(session), []
    nominal = np.ones(6) if path == "mcap" else NOMINAL
    for i, sensor in enumerate(result.sensors):
        pairs = [(sensor.bias, case.world.bias[i])]
        if i in FELT:
            pairs.append((sensor.scale, nominal[i] * case.world.scale[i]))
        offs += [np.inf if e.value is None or not e.sigma else abs(e.value - true) / (2 * e.sigma) for e, true in pairs]
    return float(max(offs))


def drawn(fault: str, path: str, rng: np.random.Generator) -> DrawnFile:
    """One file of a new block."""
    made = world(rng)
    case = Case(made, rng, np.round(made.counts), made.time, RATE, bool(rng.random() < 0.5))
    case = FAULTS[fault](case) if fault in FAULTS else case
    try:
        session = read_session(PATHS[path](case), path)
        worst = worst_of(session, case, path)
        kinds = tuple(sorted({f.kind for f in calibrate(session).screening}))
    except SessionError as refused:
        return DrawnFile(fault, path, "refused", said=str(refused)[:160])
    if worst <= 3:
        return DrawnFile(fault, path, "by name" if kinds else "right", kinds, worst)
    return DrawnFile(fault, path, "named, numbers off" if kinds else "SILENTLY WRONG", kinds, worst)


def draws(n: int, seed: int) -> Iterator[DrawnFile]:
    """Every fault on every path, and as many sound files as a fault has, over again."""
    places = [(f, p) for f in (*FAULTS, "sound") for p in PATHS if not (p == "mcap" and f in NO_RATE)]
    for k in range(n):
        fault, path = places[k % len(places)]
        yield drawn(fault, path, np.random.default_rng([seed, k]))


OUTCOMES = ("right", "by name", "refused", "named, numbers off", "SILENTLY WRONG")


def table(n: int, seed: int) -> str:
    """Table of the numbers of outcomes, fault by fault."""
    found = list(draws(n, seed))
    lines = [
        f"| fault | {' | '.join(OUTCOMES)} | kinds | worst, U |",
        "| --- |" + " ---: |" * len(OUTCOMES) + " --- | ---: |",
    ]
    for fault in (*FAULTS, "sound", "all"):
        of = [d for d in found if fault in ("all", d.fault)]
        tally, kinds = Counter(d.outcome for d in of), Counter(kind for d in of for kind in d.kinds)
        worst = max((d.worst for d in of if not np.isnan(d.worst)), default=np.nan)
        named = ", ".join(f"{kind} {count}" for kind, count in kinds.most_common(4)) if fault != "all" else ""
        cells = " | ".join(str(tally[outcome]) for outcome in OUTCOMES)
        lines.append(f"| {fault} | {cells} | {named} | {worst:.1f} |")
    return "\n".join(lines)


def main() -> None:
    """Prints the table; ``--list`` every file as well."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--n", type=int, default=400)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--list", action="store_true")
    asked = parser.parse_args()
    if asked.list:
        for one in draws(asked.n, asked.seed):
            print(one, flush=True)
        return
    print(table(asked.n, asked.seed))


if __name__ == "__main__":
    main()
