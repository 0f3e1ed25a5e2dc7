"""Marks of answers, each with its 95 % interval (Wilson)."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from benchmarks.blind.entrants import ENTRANTS
from benchmarks.blind.folder import Answers, Secret, require_same
from benchmarks.study.rates import rate
from benchmarks.study.report import mean, of_kind, table
from tests.blind.score import Outcome, score

SILENT: dict[str, Any] = {"findings": [], "unexplained": False}
"""Placeholder of the answer to a session that has none."""
NAMED = "one effect, separated from every rival: cause named"
NEAR = "one effect, near a rival: named, or listed where it is not sure"
WRONG = "one effect: a wrong name without the right one beside it"
SOUND = "sound session: something named"
TWO = "two effects: both named, or listed beside the first name"
LEADING = (NAMED, NEAR, WRONG, SOUND, TWO)
"""Marks that a comparison begins with."""


def outcomes(folder: Path, secret: Secret, given: Sequence[Answers]) -> Iterator[tuple[Outcome, ...]]:
    """Every session marked, for everybody; its files must be those of the secret."""
    for number, case in secret.cases():
        require_same(folder, number, case)
        yield tuple(score(case, _whole(one.answers.get(number, SILENT)), 0.0) for one in given)


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


def marks(marked: Sequence[Outcome]) -> list[tuple[str, str]]:
    """Each mark with what was measured."""
    single, sound, outside, two = (of_kind(list(marked), kind) for kind in ("single", "none", "outside", "two"))
    apart = [o for o in single if o.separated]
    near = [o for o in single if not o.separated]
    return [
        (NAMED, str(rate([right_cause(o) for o in apart]))),
        ("the same, on the right sensors", str(rate([o.first for o in apart]))),
        (NEAR, str(rate([o.listed for o in near]))),
        (WRONG, str(rate([is_wrong(o) for o in single]))),
        ("one effect: alternatives, mean", mean(len(o.alternatives) for o in single)),
        (
            "amplitude within U, two standard uncertainties",
            str(rate([abs(p.value) <= 2 for o in single for p in o.pulls])),
        ),
        (SOUND, str(rate([bool(o.findings) for o in sound]))),
        ("sound session: called unexplained", str(rate([o.unexplained for o in sound]))),
        ("effect outside the catalogue: called unexplained", str(rate([o.unexplained for o in outside]))),
        ("effect outside the catalogue: a wrong name", str(rate([bool(o.findings) for o in outside]))),
        (TWO, str(rate([all(o.offered) for o in two]))),
    ]


def marked_table(marked: Sequence[Outcome]) -> str:
    """The marks of one."""
    return table(("mark", "measured"), marks(marked))


def compared(names: Sequence[str], marked: Sequence[Sequence[Outcome]], sessions: int) -> str:
    """The marks of several, as a page."""
    each = [dict(marks(own)) for own in marked]
    words = {name: ENTRANTS[name].words if name in ENTRANTS else name for name in names}
    short = [(words[name], *(own[mark] for mark in LEADING)) for name, own in zip(names, each, strict=True)]
    rows = [(mark, *(own[mark] for own in each)) for mark in each[0]]
    return (
        f"# Blind sessions: who names what\n\n{sessions} sessions of [the open benchmark]"
        "(../../../docs/diagnosis/blind.md), all answered by everybody. Intervals: 95 % (Wilson).\n\n"
        f"{table(('by', *LEADING), short)}\n\n{table(('mark', *names), rows)}\n"
    )
