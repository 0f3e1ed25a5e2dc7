"""Do stated probabilities mean what they say: of causes called 70 % likely, do 70 % act?

Most lines of a ranking state next to nothing and are right. So the error is told of those between one and 99 % too,
beside what it would be by chance if every one of them meant what it says.
"""

from statistics import fmean

import numpy as np

from benchmarks.details import in_full
from benchmarks.study.rates import rate
from benchmarks.study.report import table
from tests.blind.score import Outcome

BINS = 10
DRAWS = 2000
"""Draws of truths from the stated probabilities, for the error that chance makes: their mean to some per cent."""
PLAIN = 0.01
"""Below it, and above one less it, a cause is as good as ruled out or sure."""

INTRODUCTION = (
    "Of one effect hidden in a session, every probability that the ranking states, with how often it was right. The "
    "error is the mean distance between the two."
)


def section(outcomes: list[Outcome]) -> str:
    """Markdown, of single effects, strong and weak."""
    single = [o for o in outcomes if o.kind in ("single", "weak")]
    stated = [belief for o in single for belief in o.beliefs]
    open_ones = [(p, right) for p, right in stated if PLAIN <= p <= 1 - PLAIN]
    none = [o for o in outcomes if o.kind == "none"]
    whole = ("mean absolute error over ten bins", "≤ 3 %", f"{100 * error(stated):.1f} % of {len(stated)}")
    rows = [
        ("the same of statements between 1 and 99 %", f"{100 * error(open_ones):.1f} % of {len(open_ones)}"),
        ("by chance, if every statement were right", f"{100 * by_chance(open_ones):.1f} %"),
        ("mean probability given to the true cause (fault isolation accuracy)", f"{100 * accuracy(single):.1f} %"),
        ("something found where an effect is hidden", rate([bool(o.findings) or o.unexplained for o in single])),
        ("something found where there is none", rate([bool(o.findings) or o.unexplained for o in none])),
    ]
    bins = [
        (f"{10 * k}–{10 * k + 10} %", f"{100 * said:.1f} %", rate(marks))
        for k, (said, marks) in enumerate(binned(stated))
        if marks
    ]
    return (
        f"## Probabilities\n\n{INTRODUCTION}\n\n"
        + table(("figure", "target", "measured"), [whole])
        + "\n\n"
        + in_full(f"{table(('figure', 'measured'), rows)}\n\n{table(('stated', 'mean', 'true'), bins)}")
    )


def binned(stated: list[tuple[float, bool]]) -> list[tuple[float, list[bool]]]:
    """Mean stated probability in every tenth, and whether each statement was true."""
    place = np.minimum(np.array([p for p, _ in stated]) * BINS, BINS - 1).astype(int)
    found = []
    for k in range(BINS):
        inside = [belief for belief, own in zip(stated, place, strict=True) if own == k]
        found.append((fmean([p for p, _ in inside]) if inside else 0.0, [right for _, right in inside]))
    return found


def error(stated: list[tuple[float, bool]]) -> float:
    """Mean over the bins, each by its number of statements, of |stated − true|."""
    return sum(len(marks) * abs(said - fmean(marks)) for said, marks in binned(stated) if marks) / max(len(stated), 1)


def by_chance(stated: list[tuple[float, bool]]) -> float:
    """The mean error of as many statements that mean what they say."""
    rng, likely = np.random.default_rng(1), np.array([p for p, _ in stated])
    drawn = rng.random((DRAWS, len(likely))) < likely
    return fmean([error([(p, bool(r)) for p, r in zip(likely, one, strict=True)]) for one in drawn])


def accuracy(single: list[Outcome]) -> float:
    """Mean probability given to the cause that acts, none where nothing was named."""
    return fmean([sum(p for p, right in o.beliefs if right) for o in single]) if single else float("nan")
