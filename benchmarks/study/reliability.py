"""Do stated probabilities mean what they say: of causes called 70 % likely, do 70 % act?"""

from statistics import fmean

import numpy as np

from benchmarks.study.rates import rate
from benchmarks.study.report import table
from tests.blind.score import Outcome

BINS = 10

INTRODUCTION = (
    "Of one effect hidden in a session, every probability that the ranking states, with how often it was right. The "
    "error is the mean over all statements of the distance between what the bin says and what is so."
)


def section(outcomes: list[Outcome]) -> str:
    """Markdown, of single effects, strong and weak."""
    single = [o for o in outcomes if o.kind in ("single", "weak")]
    stated = [belief for o in single for belief in o.beliefs]
    none = [o for o in outcomes if o.kind == "none"]
    rows = [
        ("mean absolute error over ten bins", "≤ 3 %", f"{100 * error(stated):.1f} % of {len(stated)}"),
        ("mean probability given to the true cause (fault isolation accuracy)", "", f"{100 * accuracy(single):.1f} %"),
        ("something found where an effect is hidden", "", rate([bool(o.findings) or o.unexplained for o in single])),
        ("something found where there is none", "", rate([bool(o.findings) or o.unexplained for o in none])),
    ]
    bins = [
        (f"{10 * k}–{10 * k + 10} %", f"{100 * said:.1f} %", rate(marks))
        for k, (said, marks) in enumerate(binned(stated))
        if marks
    ]
    return (
        f"## Probabilities\n\n{INTRODUCTION}\n\n"
        + table(("figure", "target", "measured"), rows)
        + "\n\n"
        + table(("stated", "mean", "true"), bins)
    )


def binned(stated: list[tuple[float, bool]]) -> list[tuple[float, list[bool]]]:
    """For every tenth the mean probability stated, and whether each was true."""
    place = np.minimum(np.array([p for p, _ in stated]) * BINS, BINS - 1).astype(int)
    found = []
    for k in range(BINS):
        inside = [belief for belief, own in zip(stated, place, strict=True) if own == k]
        found.append((fmean([p for p, _ in inside]) if inside else 0.0, [right for _, right in inside]))
    return found


def error(stated: list[tuple[float, bool]]) -> float:
    """Mean over the bins, each by its number of statements, of |stated − true|."""
    return sum(len(marks) * abs(said - fmean(marks)) for said, marks in binned(stated) if marks) / max(len(stated), 1)


def accuracy(single: list[Outcome]) -> float:
    """Mean probability given to the cause that acts, none where nothing was named."""
    return fmean([sum(p for p, right in o.beliefs if right) for o in single]) if single else float("nan")
