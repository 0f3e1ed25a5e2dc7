"""``python -m benchmarks.study.groups --groups 100 --seed 1`` writes docs/diagnosis/groups.md.

``--groups`` is the number of groups with one effect; the other parts have a fixed share of it.
"""

import argparse
import json
import os
import sys
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

from benchmarks.details import publish
from benchmarks.study.group_page import page
from benchmarks.study.looks import e_process
from estimator import (
    CalibrationSession,
    GroupDiagnosis,
    SessionStatistics,
    diagnose,
    diagnose_group,
    read_session,
    statistics_of,
)
from estimator.calibration.calibrate import averaged
from estimator.diagnosis.residuals.flipped_run import with_its_flip
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.groups.fixed import EMPIRICAL, FixedEffect, added_by
from estimator.groups.learned import HELD_OUT
from estimator.groups.priors import ALPHA
from tests.blind.group_score import score
from tests.blind.groups import OF_GRAMMAR, OUTSIDE, Group, draw_group
from tests.blind.physics import mean_readings

PAGE = Path(__file__).parents[2] / "docs" / "diagnosis" / "groups.md"
LOOKS = 100
"""Sessions of a life without an effect."""
DESIGNS = 10
"""Sessions that are simulated whole for a life, and those of an effect of the grammar; the scores of a life's further
ones are drawn anew."""
TIMED = 10
"""Every so many groups a diagnosis is timed beside the statistics of its session."""


@dataclass(frozen=True)
class Task:
    """One group of the study."""

    part: str
    level: str
    kind: str
    form: str
    misstated: bool
    seed: tuple[int, int, int]


def tasks(groups: int, seed: int) -> Iterator[Task]:
    """Every group, the parts in turn."""
    levels = ("unit", "stand", "type")
    for k in range(groups):
        level = levels[k % 3]
        yield Task("one", level, "one", "same", False, (seed, 1, k))
        if k % 2 == 0:
            yield Task("spread", levels[k // 2 % 3], "one", "spread", False, (seed, 2, k))
        if k % 4 == 0:
            yield Task("since", levels[k // 4 % 3], "one", "since", False, (seed, 3, k))
            yield Task("two", levels[k // 4 % 3], "two", "same", False, (seed, 4, k))
        for again in range(2):
            yield Task("none", levels[k % 3], "none", "same", bool(again), (seed, 5 + 6 * again, k))
        if k % 3 == 1:
            yield Task("misstated", levels[k // 3 % 3], "one", "same", True, (seed, 6, k))
        if k % 3 == 2:
            yield Task("outside", levels[k // 3 % 2], OUTSIDE, "same", False, (seed, 7, k))
        for again in range(2):
            level = ("unit", "unit", "type")[(2 * k + again) % 3]
            yield Task("grammar", level, OF_GRAMMAR, "same", False, (seed, 9 + again, k))
        yield Task("life", levels[k % 3], "none", "same", False, (seed, 8, k))


def perform(task: Task) -> dict[str, Any]:
    """The marks of one group, plain, so that they can be kept as JSON."""
    size = DESIGNS if task.part in ("life", "grammar") else None
    quiet = task.part == "one" and task.seed[2] % 2 == 1
    group = draw_group(
        task.level, task.kind, task.seed, form=task.form, size=size, misstated=task.misstated, quiet=quiet
    )
    if task.part == "life":
        return {"part": task.part, "level": task.level, "largest": life(group, np.random.default_rng(task.seed))}
    sessions = [read_session(f) for f in group.sessions]
    begun = time.process_time()
    kept = [statistics_of(s) for s in sessions]
    seconds = (time.process_time() - begun) / len(kept)
    found = diagnose_group(sessions, task.level)
    outcome = score(group, found.to_dict(), task.misstated)
    marks = asdict(outcome) | {"part": task.part, "clear": bool(group.truths) and outcome.clear}
    marks["first_strength"] = first_strength(group, kept)
    if task.kind == OUTSIDE:
        marks |= prediction(group, sessions, found)
    if task.seed[2] % TIMED == 0:
        begun = time.process_time()
        diagnose(sessions[-1])
        marks["share"] = seconds / (time.process_time() - begun)
    return marks


def prediction(group: Group, sessions: list[CalibrationSession], found: GroupDiagnosis) -> dict[str, float]:
    """Correlation of learned terms with the noise-free effect in the sessions left out of their fit, and the share
    explained.
    """
    truth, said = [], []
    for k in range(HELD_OUT - 1, len(sessions), HELD_OUT):
        residuals = WhitenedResiduals.of(with_its_flip(averaged(sessions[k])))
        world, effects = group.worlds[k], group.effects[k]
        change = (mean_readings(world, effects) - mean_readings(world)) / world.unit.scale
        truth.append(residuals.trace(change[..., None])[:, 0])
        learned = [
            FixedEffect(EMPIRICAL, t.sensors, "", t.amplitude, t.sigma, None, False, t.words)
            for t in found.terms
            if t.subject in sessions[k].subjects
        ]
        added = added_by(residuals.baseline, learned, ())
        effect = np.zeros_like(change) if added is None else added.columns @ added.amplitude
        said.append(residuals.trace(effect[..., None])[:, 0])
    x, y = np.concatenate(truth), np.concatenate(said)
    size = float(x @ x)
    if not size:
        return {}
    alike = float(x @ y / np.sqrt(max(size * (y @ y), 1e-300)))
    return {"correlation": alike, "explained": 1 - float((x - y) @ (x - y)) / size}


def first_strength(group: Group, kept: list[SessionStatistics]) -> float | None:
    """True pooled strength of the only effect at the session at which a look first says that something is there."""
    if len(group.truths) != 1 or group.kind in (OUTSIDE, OF_GRAMMAR):
        return None
    reached = np.flatnonzero(e_process(kept, group.level) >= -np.log(ALPHA))
    strengths = np.array(group.truths[0].strengths)
    return float(np.linalg.norm(strengths[: reached[0] + 1])) if len(reached) else None


def life(group: Group, rng: np.random.Generator) -> float:
    """Largest ln e-value over the looks at a group without an effect.

    The first sessions are simulated whole. The others have their schedules and sensors, and scores drawn from the
    normal distribution that their information states.
    """
    kept = [statistics_of(read_session(f)) for f in group.sessions]
    roots = []
    for s in kept:
        values, vectors = np.linalg.eigh(s.information)
        roots.append(vectors * np.sqrt(np.clip(values, 0, None)))
    later = [
        replace(kept[k % DESIGNS], score=roots[k % DESIGNS] @ rng.standard_normal(len(kept[k % DESIGNS].score)))
        for k in range(DESIGNS, LOOKS)
    ]
    return float(e_process([*kept, *later], group.level).max())


def main() -> None:
    """Run the study and write its page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.study.groups", description=__doc__)
    parser.add_argument("--groups", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--part", help="only this part")
    parser.add_argument("--out", type=Path, default=PAGE)
    parser.add_argument("--marks", type=Path, help="file that keeps the marks of every group, one a line")
    parser.add_argument("--only-page", action="store_true", help="make the page of marks that were kept")
    options = parser.parse_args()
    marks = read_marks(options.marks) if options.marks and options.marks.exists() else []
    if not options.only_page:
        for task in tasks(options.groups, options.seed):
            if options.part in (None, task.part):
                marks.append(perform(task))
                keep(options.marks, marks[-1])
                print(f"\r{len(marks)}", end="", file=sys.stderr)
    text = page(marks, f"python -m benchmarks.study.groups --groups {options.groups} --seed {options.seed}")
    publish(text, options.out)
    print(text)


def read_marks(path: Path) -> list[dict[str, Any]]:
    """Marks that an earlier run kept."""
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


def keep(path: Path | None, one: dict[str, Any]) -> None:
    """Append the marks of one group."""
    if path is not None:
        with path.open("a", encoding="utf-8") as file:
            file.write(json.dumps(one) + "\n")


if __name__ == "__main__":
    main()
