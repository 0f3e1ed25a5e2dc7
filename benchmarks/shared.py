"""``python -m benchmarks.shared --sessions 12 --seed 1`` writes docs/diagnosis/shared.md.

Courses that several sensors share, drawn by code that the estimator does not share: one finding and nothing else is
right. Beside them, sessions where a shared course would be wrong.
"""

import argparse
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from time import process_time

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from scipy.optimize import brentq
from scipy.stats import chi2, ncx2

from benchmarks.details import in_full, publish
from benchmarks.study.rates import rate
from benchmarks.study.report import table
from estimator import Diagnosis, diagnose, read_session
from tests.blind.courses import BLOCKS, COURSES, Driven, draw_apart, draw_course
from tests.blind.steps import OTHERS, RAMPS, WALKS, Block, Stepped, draw_others

PAGE = Path(__file__).parents[1] / "docs" / "diagnosis" / "shared.md"
STRENGTH = 14.0
"""Strength of all sensors together, standard errors."""
EACH = 12.0
"""Strength of every sensor's independent drift, standard errors."""
LEVEL = 0.003
"""Family-wise level of the diagnosis, and that of the oracle's one test."""
POWER = 0.95
TIMES = (1.0, 1.3, 1.6)
"""Strengths in those that the oracle finds with `POWER`."""
STAND, GYROS, TWELVE, MANY = BLOCKS
SHARED, APART, OWN, SOUND, FAINT = "shared", "apart", "own", "sound", "faint"
ROOM = "room"
NAMES = {"exponential": "warm-up", "step": "bias-jump", "ramp": "bias-ramp", ROOM: "shared-course"}

INTRODUCTION = (
    "Some sensors of a block follow one course, each by a size and sign of its own (log-normal, σ 0.6), all together "
    f"by {STRENGTH:g} standard errors beside what the calibration absorbs: settling with a time constant of an eighth "
    "to a half of the session, a step, a ramp, a room that nobody recorded. The physics is written a second time, "
    "apart from the estimator. Intervals: 95 % (Wilson)."
)

MISSED = (
    "What is missed is mostly a slow room or a ramp: it differs little from biases that wander each by itself, which "
    "are taken for as likely as a course that no formula gives, so that drifts of each sensor are not called shared. "
    "Sensors that settle each with a time constant of its own, between an eighth and a half of the session, differ "
    "as little from one course as the evidence between both says: of its odds below a hundred the finding says that "
    "each may have its own."
)


@dataclass(frozen=True)
class Wish:
    """One session."""

    kind: str
    block: Block
    course: str
    strength: float
    seed: tuple[int, ...]


@dataclass(frozen=True)
class Answer:
    """The answer to one session."""

    wish: Wish
    one: bool
    """Whether one shared course is found, and nothing else."""
    right: bool
    """Whether it also has the right name."""
    seen: bool
    """Whether an oracle that knows the course would see other sensors follow it beside the strongest."""
    shared: bool
    sure: bool
    """Whether one shape is claimed for all, without saying that each may have its own."""
    named: bool
    bystanders: int
    """Sensors named that do not follow."""
    away: float | None
    """The time constant's error in sigmas."""
    seconds: float


def wishes(sessions: int, seed: int) -> Iterator[Wish]:
    """Wishes for ``sessions`` sessions of every kind; for sound ones four times as many."""
    for b, block in enumerate(BLOCKS):
        for c, course in enumerate(COURSES):
            yield from (Wish(SHARED, block, course, STRENGTH, (seed, 1, b, c, k)) for k in range(sessions))
    for b, block in enumerate((STAND, TWELVE)):
        for c, course in enumerate((WALKS, RAMPS, ROOM)):
            yield from (Wish(APART, block, course, EACH, (seed, 2, b, c, k)) for k in range(2 * sessions))
        yield from (Wish(OWN, block, "exponential", EACH, (seed, 5, b, k)) for k in range(2 * sessions))
        yield from (Wish(SOUND, block, "", 0.0, (seed, 3, b, k)) for k in range(4 * sessions))
    for t, times in enumerate(TIMES):
        yield from (Wish(FAINT, MANY, "exponential", times, (seed, 4, t, k)) for k in range(sessions))


def drawn(wish: Wish) -> Driven | Stepped:
    """The session."""
    rng, m = np.random.default_rng(wish.seed), wish.block.accelerometers + wish.block.gyros
    if wish.kind == APART and wish.course in OTHERS:
        return draw_others(wish.block, wish.course, wish.strength, rng)
    if wish.kind in (APART, OWN):
        return draw_apart(wish.block, wish.course, m, wish.strength, rng)
    if wish.kind == FAINT:
        return draw_course(wish.block, wish.course, m, wish.strength * oracle(m) * np.sqrt(m), rng, even=True)
    if wish.kind == SOUND:
        return draw_course(wish.block, "ramp", 1, 0.0, rng)
    return draw_course(wish.block, wish.course, int(rng.integers(m // 2, m + 1)), wish.strength, rng)


def oracle(m: int) -> float:
    """Strength of each of m sensors that one χ² test finds which knows the course but for the sizes."""
    bound = float(chi2.isf(LEVEL, m))
    whole = brentq(lambda square: ncx2.sf(bound, m, square) - POWER, 1.0, 1e4)
    return float(np.sqrt(whole / m))


def others_seen(hidden: Driven | Stepped, m: int) -> bool:
    """Whether one χ² test of all m sensors but the strongest, which knows the course but for the sizes, may be expected
    to find that they follow.
    """
    squares = np.sort(np.square(hidden.strength)) if isinstance(hidden, Driven) and hidden.strength else np.zeros(1)
    return bool(squares[:-1].sum() + m - 1 > chi2.isf(LEVEL, m - 1))


def perform(wish: Wish, diagnosing: Callable[..., Diagnosis] = diagnose) -> Answer:
    """Draw and diagnose."""
    hidden = drawn(wish)
    session, begun = read_session(hidden.session), process_time()
    named = diagnosing(session).findings
    seconds = process_time() - begun
    shared = [f for f in named if f.shared is not None]
    away = None
    if shared and isinstance(hidden, Driven) and wish.course == "exponential" and shared[0].cause == "warm-up":
        shape = shared[0].shared
        assert shape is not None
        away = (shape.shape["s"] - hidden.shape) / shape.shape_sigma["s"] if shape.shape_sigma else None
    bystanders = sum(name not in hidden.sensors for f in shared for name in f.sensors)
    one = len(named) == len(shared) == 1
    right = one and shared[0].cause == NAMES.get(wish.course)
    seen = others_seen(hidden, wish.block.accelerometers + wish.block.gyros)
    sure = any(f.shared is not None and not f.shared.shape_in_doubt for f in shared)
    return Answer(wish, one, right, seen, bool(shared), sure, bool(named), bystanders, away, seconds)


def page(answers: Sequence[Answer], command: str) -> str:
    """Markdown."""
    parts = [
        f"# Courses that sensors share\n\nMade by `{command}`. {INTRODUCTION}",
        in_full(targets(answers)),
        f"[Every target, and what is measured](shared-causes.md#shared-courses). {MISSED}",
        courses(answers),
    ]
    return "\n\n".join(parts) + "\n"


def of(answers: Sequence[Answer], kind: str, course: str = "", block: Block | None = None) -> list[Answer]:
    """The answers of one kind, course and block; of all where none is named."""
    return [
        a for a in answers if a.wish.kind == kind and course in ("", a.wish.course) and block in (None, a.wish.block)
    ]


def targets(answers: Sequence[Answer]) -> str:
    """The table of targets."""
    shared = of(answers, SHARED)
    known = [a.away for a in shared if a.away is not None]
    rows = [
        ("one shared course: one finding of it, nothing else", "≥ 95 %", rate([a.one for a in shared])),
        (
            "the same, where an oracle that knows the course sees others follow beside the strongest sensor",
            "≥ 95 %",
            rate([a.one for a in shared if a.seen]),
        ),
        ("one finding, under its own name", "", rate([a.right for a in shared])),
        ("the time constant within U (k = 2)", "93–97 %", rate([abs(z) < 2 for z in known])),
        ("a sensor named that does not follow, of such sessions", "≤ 5 %", rate([a.bystanders > 0 for a in shared])),
        ("independent drifts: one course claimed", "≤ 1 %", rate([a.shared for a in of(answers, APART)])),
        ("each its own time constant: one course named", "", rate([a.shared for a in of(answers, OWN)])),
        ("the same: one time constant claimed for sure", "≤ 1 %", rate([a.sure for a in of(answers, OWN)])),
        ("sound sessions: a name", "≤ 1 %", rate([a.named for a in of(answers, SOUND)])),
    ]
    for times in TIMES:
        found = [a.shared for a in of(answers, FAINT) if a.wish.strength == times]
        words = f"24 sensors, each {times:g} times what an oracle needs that knows the course ({oracle(24):.2f}): found"
        rows.append((words, "≥ 95 %" if times == max(TIMES) else "", rate(found)))
    rows.append(("time of a diagnosis over that of a sound session", "≤ 3", slower(answers)))
    return table(("", "target", "measured"), rows)


def slower(answers: Sequence[Answer]) -> str:
    """Processor time of a session with a shared course over that of a sound one, of two blocks."""
    values = []
    for block in (STAND, TWELVE):
        sound, shared = (np.median([a.seconds for a in of(answers, kind, block=block)]) for kind in (SOUND, SHARED))
        values.append(f"{shared / sound:.1f} ({block.name})")
    return ", ".join(values)


def courses(answers: Sequence[Answer]) -> str:
    """One finding that names the course, by block and course; independent drifts, by kind."""
    rows = [(b.name, *(rate([a.one for a in of(answers, SHARED, c, b)]) for c in COURSES)) for b in BLOCKS]
    own = [
        (b.name, *(rate([a.shared for a in of(answers, APART, c, b)]) for c in (WALKS, RAMPS, ROOM)))
        for b in (STAND, TWELVE)
    ]
    right = [(b.name, *(rate([a.right for a in of(answers, SHARED, c, b)]) for c in COURSES)) for b in BLOCKS]
    return in_full(
        "## One finding, by course\n\n"
        + table(("block", *COURSES), rows)
        + "\n\nUnder its own name; a slow room may pass for settling or a ramp, and one of these for the other:\n\n"
        + table(("block", *COURSES), right)
        + f"\n\n## Independent drifts, strength {EACH:g} each: one course claimed\n\n"
        + table(("block", "walks", "ramps from a row of its own", "a room of its own"), own)
    )


def main() -> None:
    """Run it and write its page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.shared", description=__doc__)
    parser.add_argument("--sessions", type=int, default=12)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--out", type=Path, default=PAGE)
    options = parser.parse_args()
    work, answers = list(wishes(options.sessions, options.seed)), list[Answer]()
    with ProcessPoolExecutor(options.processes, mp_context=get_context("spawn")) as pool:
        for answer in pool.map(perform, work):
            answers.append(answer)
            print(f"\r{len(answers)}/{len(work)}", end="", file=sys.stderr)
    text = page(answers, f"python -m benchmarks.shared --sessions {options.sessions} --seed {options.seed}")
    publish(text, options.out)
    print(f"\n{text}")


if __name__ == "__main__":
    main()
