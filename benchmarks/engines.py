"""``python -m benchmarks.engines --sessions 300 --seed 1`` writes benchmarks/results/diagnosis/engines.md.

The diagnosis by rules and the one by a posterior side by side, on the same sessions: those of the study, of noise that
is stated wrongly or has tails, and of courses that sensors share. Neither is given what only all sessions of a unit
together show.
"""

import argparse
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from multiprocessing import get_context
from statistics import median
from typing import Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from benchmarks import shared
from benchmarks.details import RESULTS
from benchmarks.study import examine, other_noise, stated_noise
from benchmarks.study.rates import rate
from benchmarks.study.report import table
from estimator.causes import CATALOGUE
from estimator.causes.contract import Cause
from estimator.diagnosis import Diagnosis, diagnose
from estimator.diagnosis.posterior.write import posterior
from estimator.session import CalibrationSession
from tests.blind.cases import draw_case
from tests.blind.examine import examine as marked
from tests.blind.score import Outcome

PAGE = RESULTS / "diagnosis" / "engines.md"
Line = tuple[str, list[bool]]
"""A figure in words, and whether each session that it is of has it."""


def by_rules(
    session: CalibrationSession,
    history: Sequence[CalibrationSession] = (),
    catalogue: Sequence[Cause] = CATALOGUE,
) -> Diagnosis:
    """The diagnosis in use."""
    return diagnose(session, history, catalogue=catalogue)


def by_posterior(
    session: CalibrationSession,
    history: Sequence[CalibrationSession] = (),
    catalogue: Sequence[Cause] = CATALOGUE,
) -> Diagnosis:
    """The diagnosis that is to take its place."""
    return diagnose(session, history, catalogue=catalogue, search=posterior)


ENGINES = {"rules": by_rules, "posterior": by_posterior}


@dataclass(frozen=True)
class Job:
    """One session to be diagnosed."""

    part: str
    wish: Any
    engine: str


def perform(job: Job) -> Any:
    """The marks of one engine's answer."""
    engine = ENGINES[job.engine]
    if job.part == "study":
        return marked(draw_case(job.wish.kind, job.wish.seed, job.wish.cause), None, engine)
    parts: dict[str, Callable[..., Any]] = {
        "stated": stated_noise.perform, "other": other_noise.perform, "shared": shared.perform,
    }  # fmt: skip
    return parts[job.part](job.wish, engine)


def wishes(sessions: int, seed: int) -> Iterator[tuple[str, Any]]:
    """The sessions of every part."""
    yield from (("study", task) for task in examine.tasks(sessions, seed))
    few = max(sessions // 100, 1)
    yield from (("stated", wish) for wish in stated_noise.wishes(few, seed + 1))
    yield from (("other", wish) for wish in other_noise.wishes(4 * few, seed))
    yield from (("shared", wish) for wish in shared.wishes(2 * few, seed))


def lines(part: str, answers: list[Any]) -> Iterator[Line]:
    """The figures of a part."""
    if part == "study":
        yield from study_lines(answers)
    if part in ("stated", "other"):
        words = "noise stated wrongly" if part == "stated" else "tails, unequal noise, logs by hand"
        yield f"{words}: sound, a name other than noise", [a.other_name for a in answers if not a.wish.hidden]
        yield f"{words}: an effect named or listed", [a.offered for a in answers if a.wish.hidden]
    if part == "shared":
        of = partial(shared.of, answers)
        yield "a course that sensors share: one finding, nothing else", [a.one for a in of("shared")]
        yield "the same under its own name", [a.right for a in of("shared")]
        yield "a sensor named that does not follow", [a.bystanders > 0 for a in of("shared")]
        yield "independent drifts: one course claimed", [a.shared for a in of("apart")]
        yield "each its own time constant: one claimed for sure", [a.sure for a in of("own")]
        yield "24 faint sensors that share a course: found", [a.shared for a in of("faint")]


def study_lines(outcomes: list[Outcome]) -> Iterator[Line]:
    """The figures of the study."""
    of = {kind: [o for o in outcomes if o.kind == kind] for kind in examine.SHARES}
    single, two, outside = of["single"], of["two"], of["outside"]
    yield "separated from every rival: named first", [o.first for o in single if o.separated]
    yield "one effect: named first", [o.first for o in single]
    yield "one effect: named or listed", [o.listed for o in single]
    yield "one effect: another name beside", [is_other(o) for o in single]
    yield "faint effect: named or listed", [o.listed for o in of["weak"]]
    yield "sound: a name", [bool(o.findings) for o in of["none"]]
    yield "outside the catalogue: any name", [bool(o.findings) for o in outside]
    yield "outside the catalogue: a name, and not said to be doubtful", [is_sure(o) for o in outside]
    yield "outside the catalogue: `unexplained`", [o.unexplained for o in outside]
    yield "two effects: both named", [all(o.named) for o in two]
    yield "two effects: both named or listed", [all(o.offered) for o in two]


def is_other(outcome: Outcome) -> bool:
    """Whether a name is given that is none of those hidden."""
    return any(f.split("@")[0] not in outcome.causes for f in outcome.findings)


def is_sure(outcome: Outcome) -> bool:
    """Whether a name is given without a word that it may be something else."""
    return bool(outcome.findings) and not (outcome.unexplained or outcome.unexplained_listed)


def page(answers: dict[str, dict[str, list[Any]]], command: str) -> str:
    """Markdown."""
    rows = []
    for part in answers["rules"]:
        each = [list(lines(part, answers[engine][part])) for engine in ENGINES]
        rows += [(words, *(rate(marks) for marks in all_marks)) for words, all_marks in together(each)]
    for part in ("study", "shared"):
        seconds = [median(a.seconds for a in answers[engine][part]) for engine in ENGINES]
        rows.append((f"{part}: median time of a diagnosis", *(f"{s / seconds[0]:.2f}" for s in seconds)))
    title = f"# Diagnosis by rules and by one posterior\n\nMade by `{command}`. Intervals: 95 % (Wilson)."
    return f"{title}\n\n{table(('', *ENGINES), rows)}\n"


def together(each: list[list[Line]]) -> Iterator[tuple[str, list[list[bool]]]]:
    """The same figure of every engine."""
    for of_engines in zip(*each, strict=True):
        yield of_engines[0][0], [marks for _, marks in of_engines]


def main() -> None:
    """Diagnose and write the page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.engines", description=__doc__)
    parser.add_argument("--sessions", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    jobs = [Job(part, wish, engine) for part, wish in wishes(options.sessions, options.seed) for engine in ENGINES]
    answers: dict[str, dict[str, list[Any]]] = {engine: {} for engine in ENGINES}
    with ProcessPoolExecutor(options.processes, mp_context=get_context("spawn")) as pool:
        for k, (job, answer) in enumerate(zip(jobs, pool.map(perform, jobs, chunksize=2), strict=True), 1):
            answers[job.engine].setdefault(job.part, []).append(answer)
            print(f"\r{k}/{len(jobs)}", end="", file=sys.stderr)
    text = page(answers, f"python -m benchmarks.engines --sessions {options.sessions} --seed {options.seed}")
    PAGE.write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
