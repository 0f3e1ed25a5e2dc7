"""``python -m benchmarks.study.seen.gross --n 300 --seed 1`` prints how gross readings are found, as a table.

A reading counts as named where its row and sensor stand in what the calibration set aside or among the diagnosis'
findings, or, where it may as well be cut off, the alternative of one; another sensor counts as accused by any finding,
structure or reading set aside that names it. Of triads in unknown orientations those are counted apart in which the
physics leaves several readings that may be wrong: there the suspects of a row count as named.
"""

import argparse
import os
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

from benchmarks.study.seen.gross_sessions import (
    Case,
    frozen,
    orientations,
    raw,
    single,
    sound,
    stand,
    tenth,
    three,
)
from estimator import calibrate, diagnose, read_session
from estimator.errors import ScheduleError
from estimator.results import Calibration

KINDS: dict[str, Callable[[np.random.Generator], Case]] = {
    "stand, one reading": partial(single, draw=stand),
    "orientations, one reading": partial(single, draw=partial(orientations, triad=False)),
    "triad, one reading": partial(single, draw=partial(orientations, triad=True)),
    "stand, three readings": partial(three, draw=stand),
    "orientations, three readings": partial(three, draw=orientations),
    "stand, a tenth of one sensor": partial(tenth, draw=stand),
    "orientations, a tenth of one sensor": partial(tenth, draw=orientations),
    "stand, stuck for rows": partial(frozen, draw=stand),
    "orientations, stuck for rows": partial(frozen, draw=orientations),
    "raw log, unplugged in one rest": raw,
    "stand, sound": partial(sound, draw=stand),
    "orientations, sound": partial(sound, draw=orientations),
}


@dataclass(frozen=True)
class Outcome:
    """Outcome of one session."""

    identifiable: bool
    named: bool
    others: bool
    inside: tuple[bool, ...]
    """Whether each scale factor and bias lies within its U."""
    any_reading: bool
    refused: bool = False


def outcome(case: Case, looks: bool) -> Outcome:
    """The program's answer to a case."""
    names = case.truth.names
    wanted = {(j + 1, names[i]) for j, i in case.gross}
    try:
        session = read_session(case.truth.file())
        calibration = calibrate(session)
        places, accused = set_aside(calibration)
        left_out = {name for finding in calibration.screening for name in finding.sensors}
        places |= {place for place in wanted if place[1] in left_out}
        if looks or not wanted <= places:
            diagnosis = diagnose(session)
            calibration = diagnosis.calibration
            for finding in diagnosis.findings:
                if "reading-outlier" in finding.alternatives:
                    places |= {place for place in wanted if place[1] in finding.sensors}
                accused |= set(finding.sensors) if finding.cause != "excess-noise" else set()
                if finding.cause == "reading-outlier":
                    shapes = zip(finding.sensors, finding.nonlinear_each, strict=False)
                    places |= {(int(shape["row"]), name) for name, shape in shapes if "row" in shape}
            accused |= {name for s in diagnosis.structures for name in s.sensors or ("all",)}
    except ScheduleError:
        return Outcome(case.identifiable, False, False, (), False, refused=True)
    wrong = {name for _, name in wanted}
    return Outcome(
        case.identifiable,
        wanted <= places,
        bool(wanted) and bool(accused - wrong),
        inside(case, calibration),
        bool(places),
    )


def set_aside(calibration: Calibration) -> tuple[set[tuple[int, str]], set[str]]:
    """Rows with sensors, and sensors; suspects are not accused."""
    places = {
        (row, name)
        for aside in calibration.set_aside
        for row in range(aside.row, aside.last_row + 1)
        for name in (aside.suspects or (aside.sensor,))
    }
    return places, {aside.sensor for aside in calibration.set_aside if not aside.suspects}


def inside(case: Case, calibration: Calibration) -> tuple[bool, ...]:
    """Whether the truth lies within U, for every scale factor and bias that the session determines."""
    found = []
    for i, name in enumerate(case.truth.names):
        sensor = calibration.sensor(name)
        for estimate, true in ((sensor.scale, case.truth.scale[i]), (sensor.bias, case.truth.bias[i])):
            if estimate.value is not None and estimate.sigma is not None:
                found.append(abs(estimate.value - true) <= estimate.factor() * estimate.sigma)
    return tuple(found)


def line(kind: str, n: int, seed: int, looks: bool) -> list[str]:
    """Lines of the table for one kind of session."""
    rng = np.random.default_rng([seed, list(KINDS).index(kind)])
    results = [outcome(KINDS[kind](rng), looks) for _ in range(n)]
    rows = []
    for tells in (True, False):
        some = [r for r in results if r.identifiable == tells]
        if some:
            covered = [x for r in some for x in r.inside]
            cells = (
                kind + ("" if tells else ", not identifiable"),
                len(some),
                share([r.any_reading if "sound" in kind else r.named for r in some]),
                share([r.others for r in some]),
                share(covered),
                sum(r.refused for r in some),
            )
            rows.append("| " + " | ".join(map(str, cells)) + " |")
    return rows


def share(found: list[bool]) -> str:
    """Share in per cent, with the half width of its 95 % interval."""
    if not found:
        return "–"
    n, p = len(found), float(np.mean(found))
    return f"{100 * p:.1f} ± {196 * np.sqrt(max(p * (1 - p), 1 / n) / n):.1f} %"


def table(n: int, seed: int, kinds: str = "", *, looks: bool = False) -> str:
    """Markdown: a line for every kind of session."""
    heads = ("sessions", "n", "reading named", "another sensor accused", "within U", "refused")
    lines = ["| " + " | ".join(heads) + " |", "|" + " --- |" * len(heads)]
    for kind in KINDS:
        if kinds in kind:
            lines += line(kind, n, seed, looks)
    return "\n".join(lines)


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.study.seen.gross", description=__doc__)
    parser.add_argument("--n", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kind", default="", help="only kinds whose name holds this")
    parser.add_argument("--diagnose", action="store_true", help="diagnose every session, not only those left open")
    options = parser.parse_args()
    warnings.simplefilter("error")
    print(table(options.n, options.seed, options.kind, looks=options.diagnose))


if __name__ == "__main__":
    main()
