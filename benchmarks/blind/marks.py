"""Marks of answers, each with its 95 % interval (Wilson)."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from benchmarks.blind.folder import Answers, Secret, require_same
from benchmarks.study.rates import rate
from benchmarks.study.report import mean, of_kind, table
from tests.blind.score import Outcome, score

SILENT: dict[str, Any] = {"findings": [], "unexplained": False}
"""Of a session without an answer."""


def outcomes(folder: Path, secret: Secret, given: Answers) -> Iterator[Outcome]:
    """Every session marked; its files must be those of the secret."""
    for number, case in secret.cases():
        require_same(folder, number, case)
        yield score(case, _whole(given.answers.get(number, SILENT)), 0.0)


def _whole(answer: dict[str, Any]) -> dict[str, Any]:
    """An answer with what may be left out of it."""
    empty: dict[str, Any] = {"sensors": [], "amplitude": [], "sigma": [], "alternatives": []}
    return {**SILENT, **answer, "findings": [{**empty, **finding} for finding in answer.get("findings", [])]}


def is_wrong(outcome: Outcome) -> bool:
    """Whether a name was given, and neither it nor an alternative is right."""
    return bool(outcome.findings) and not outcome.listed


def right_cause(outcome: Outcome) -> bool:
    """Whether the first name is the hidden cause, on whatever sensor."""
    return bool(outcome.findings) and outcome.findings[0].split("@")[0] in outcome.causes


def marks(marked: list[Outcome]) -> str:
    """As a table."""
    single, sound, outside, two = (of_kind(marked, kind) for kind in ("single", "none", "outside", "two"))
    apart = [o for o in single if o.separated]
    near = [o for o in single if not o.separated]
    rows = [
        ("one effect, separated from every rival: cause named", rate([right_cause(o) for o in apart])),
        ("the same, on the right sensors", rate([o.first for o in apart])),
        ("one effect, near a rival: named, or cannot tell and lists it", rate([o.listed for o in near])),
        ("one effect: a wrong name without the right one beside it", rate([is_wrong(o) for o in single])),
        ("one effect: alternatives, mean", mean(len(o.alternatives) for o in single)),
        ("amplitude within U, two standard uncertainties", rate([abs(p.value) <= 2 for o in single for p in o.pulls])),
        ("sound session: something named", rate([bool(o.findings) for o in sound])),
        ("sound session: called unexplained", rate([o.unexplained for o in sound])),
        ("effect outside the catalogue: called unexplained", rate([o.unexplained for o in outside])),
        ("effect outside the catalogue: a wrong name", rate([bool(o.findings) for o in outside])),
        ("two effects: both named, or listed beside the first name", rate([all(o.offered) for o in two])),
    ]
    return table(("mark", "measured"), rows)
