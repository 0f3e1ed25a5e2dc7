"""How often the bounds of the forecast hold what came later."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.backtest.histories import DESCRIBED, KINDS, MEASURED, STEP, History, histories
from benchmarks.study.rates import rate
from benchmarks.study.report import table
from estimator.health.forecast import AHEAD, EARLY, MEDIAN, RISK_LEVEL, passage, predictive, reach
from estimator.health.trend import trends
from estimator.session import Array

LONGEST = 1.0
"""Years; the longest interval of the unit type."""
FEW, MANY = 5, 9


@dataclass(frozen=True, eq=False)
class Outcome:
    """One history, cut somewhere, and what came after."""

    kind: str
    known: int
    """Sessions before the cut, the reference included."""
    next: float
    """Chance that was given to a value below that of the next session."""
    last: float
    """The same of the last session of all."""
    passed: float
    """Years from the cut until the truth passed the tolerance; infinite if it never did."""
    early: float
    median: float
    due: float
    """Years that were stated: the early bound, the median, the next calibration."""


def outcomes(count: int, seed: int) -> list[Outcome]:
    """So many of every kind; a step lies before the cut, because nobody foresees one."""
    rng = np.random.default_rng(seed)
    made = [history for kind in KINDS for history in histories(kind, count, rng)]
    cuts = [_cut(history, rng) for history in made]
    kept = [(h, c) for h, c in zip(made, cuts, strict=True) if c < len(h.series.time)]
    return _examined([h for h, _ in kept], [c for _, c in kept])


def _cut(history: History, rng: np.random.Generator) -> int:
    """Sessions that are known: at least three, two of them after a step; at least one is left."""
    time = history.series.time
    least = 3 if history.kind != "step" else max(4, int((time < history.onset).sum()) + 2)
    return int(rng.integers(least, max(len(time), least + 1)))


def _examined(made: Sequence[History], cuts: Sequence[int]) -> list[Outcome]:
    found = trends([history.first(cut) for history, cut in zip(made, cuts, strict=True)])
    later = [[h.series.time[k] - h.series.time[c - 1] for k in (c, -1)] for h, c in zip(made, cuts, strict=True)]
    values = np.array([[h.series.value[k] for k in (c, -1)] for h, c in zip(made, cuts, strict=True)])
    sigmas = np.array([[h.series.sigma[0]] * 2 for h in made])
    below = predictive(found, np.array(later), values, sigmas)
    chance = passage(found)
    early, median, risky = (reach(chance, level) for level in (EARLY, MEDIAN, RISK_LEVEL))
    return [
        Outcome(h.kind, c, below[i, 0], below[i, 1], _passed(h, c), early[i], median[i], min(risky[i], LONGEST))
        for i, (h, c) in enumerate(zip(made, cuts, strict=True))
    ]


def _passed(history: History, cut: int) -> float:
    start = round(history.series.time[cut - 1] / STEP)
    beyond = np.abs(history.truth[start:]) >= 1
    return float(STEP * np.argmax(beyond)) if beyond.any() else float("inf")


def coverage_page(found: Sequence[Outcome]) -> str:
    """Markdown."""
    rows = [("**all**", *_held(found))]
    rows += [(f"{kind}: {DESCRIBED[kind]}", *_held([o for o in found if o.kind == kind])) for kind in KINDS]
    rows += [
        (f"known sessions: {name}", *_held([o for o in found if low <= o.known <= high]))
        for name, low, high in (("3 to 5", 3, FEW), ("6 to 9", FEW + 1, MANY), ("10 and more", MANY + 1, 99))
    ]
    head = ("histories", "next session in 50 %", "next session in 90 %", "last in 50 %", "last in 90 %")
    late = ("histories", "passed before reach 90 (10 %)", "passed before reach 50 (50 %)", "passed before due (5 %)")
    reached = [("**all**", *_reached(found))]
    reached += [(kind, *_reached([o for o in found if o.kind == kind])) for kind in KINDS]
    return (
        "## Do the bounds hold?\n\n"
        "Each history is cut after a random session; the bounds are made from what came before and held against the "
        f"next session and the last one, up to {MEASURED:g} years on.\n\n"
        + table(head, rows)
        + "\n\nThe truth's first passage of the tolerance against the dates that were stated, where one within twelve "
        "years was; never more often than the figure in the heading is what is promised.\n\n" + table(late, reached)
    )


def _held(found: Sequence[Outcome]) -> tuple[str, ...]:
    below = np.array([[o.next, o.last] for o in found])
    return tuple(str(rate(list(_inside(below[:, k], level)))) for k in (0, 1) for level in (0.5, 0.9))


def _inside(below: Array, level: float) -> list[bool]:
    return [bool(x) for x in np.abs(below - 0.5) <= level / 2]


def _reached(found: Sequence[Outcome]) -> tuple[str, ...]:
    horizon = float(AHEAD[-1])
    stated = ([(o.early, o.passed) for o in found], [(o.median, o.passed) for o in found])
    return (
        *(str(rate([passed < date for date, passed in pairs if date < horizon])) for pairs in stated),
        str(rate([o.passed < o.due for o in found if o.passed > 0])),
    )
