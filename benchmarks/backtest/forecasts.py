"""Whether units come back in time and not too early, and whether stated dates hold, in types of many sizes."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.backtest.histories import DESCRIBED, KINDS, History, Plan
from benchmarks.backtest.units import PARAMETERS, Unit, learned, outlook, track, unit
from benchmarks.study.rates import Rate, rate
from benchmarks.study.report import table
from estimator.health.forecast import AHEAD, RISK_LEVEL, reach
from estimator.health.pooled import Prior
from estimator.health.prognosis import prognosis

LONGEST = 1.0
"""Years; the longest interval of the unit type."""
FLEET = ("stable",) * 14 + KINDS[1:]
"""Twenty units: of six, one parameter does something."""
DATED = Plan(sessions=(6, 14), since=2)
"""Steps and late ramps begin two sessions back or more."""
SESSIONS = {"2 to 3": (2, 3), "4 to 5": (4, 5), "6 to 7": (6, 7), "8 to 16": (8, 16)}
"""Of the units whose due date is looked at."""
SIZES = (1, 5, 20, 200)
"""Units of a type."""


@dataclass(frozen=True)
class Due:
    """One unit and its date, in years from its last session."""

    kind: str
    known: str
    due: float
    passed: float


@dataclass(frozen=True)
class Reached:
    """One changing parameter and the date before which it passes its tolerance with 10 %."""

    kind: str
    early: float
    passed: float


def dues(types: int, rng: np.random.Generator) -> list[Due]:
    """Of types of twenty units, so many for every number of sessions; units that are out already are left out."""
    rows = []
    for name, sessions in SESSIONS.items():
        for _ in range(types):
            rows += _dues_of(name, [unit(kind, Plan(sessions=sessions), rng) for kind in FLEET])
    return rows


def _dues_of(name: str, units: Sequence[Unit]) -> list[Due]:
    prior = learned(units)
    return [Due(one.kind, name, due_of(one, prior), one.passed) for one in units if one.passed > 0]


def due_of(one: Unit, prior: Prior) -> float:
    """Years."""
    return min(float(reach(outlook(one, prior).risk[None], RISK_LEVEL)[0]), LONGEST)


def dates_reached(types: int, rng: np.random.Generator) -> list[Reached]:
    """Of types of 21 units in which all kinds are alike."""
    found = []
    for _ in range(types):
        units = [unit(kind, DATED, rng) for kind in KINDS * 3]
        prior = learned(units)
        found += [_reached(one.kind, one.parameters[0], prior) for one in units if one.parameters[0].passed > 0]
    return found


def _reached(kind: str, one: History, prior: Prior) -> Reached:
    early = prognosis([track(one)], [prior], np.zeros(1)).outlooks[0].reach_90
    return Reached(kind, early, one.passed)


def before(found: Sequence[Reached]) -> Rate:
    """How often the tolerance was passed before the date, where one within the horizon was stated."""
    horizon = float(AHEAD[-1])
    return rate([one.passed < one.early for one in found if one.early < horizon])


def sizes_page(types: int, rng: np.random.Generator, sizes: Sequence[int]) -> str:
    """Markdown: a stable unit with four to five sessions, in types of many sizes."""
    rows = []
    for size in sizes:
        days = []
        for _ in range(types if size < max(SIZES) else 1):
            plan = Plan(sessions=SESSIONS["4 to 5"])
            units = [unit(kind, plan, rng) for kind in (FLEET * 10)[:size]]
            prior = learned(units)
            days += [365 * due_of(one, prior) for one in units[:10] if one.kind == "stable"]
        low, middle, high = np.percentile(days, (10, 50, 90))
        rows.append((size, len(days), f"{low:.0f}", f"{middle:.0f}", f"{high:.0f}"))
    head = ("units of the type", "stable units", "days to due: 10 %", "median", "90 %")
    return "## What a type of few units costs\n\nUnits with four to five sessions.\n\n" + table(head, rows)


def due_page(found: Sequence[Due]) -> str:
    """Markdown: when units come back."""
    rows = []
    for name in SESSIONS:
        own = [one for one in found if one.known == name]
        days = [365 * one.due for one in own if one.kind == "stable"]
        rows.append((name, f"{np.median(days):.0f}", str(rate([one.passed < one.due for one in own]))))
    head = ("sessions", "days to due, stable units, median", "passed before due, all units")
    kinds = [(kind, DESCRIBED[kind], str(rate([o.passed < o.due for o in found if o.kind == kind]))) for kind in KINDS]
    return (
        "## When units come back\n\n"
        f"Types of twenty units with {PARAMETERS} parameters each; in six units one parameter does something. The "
        "longest interval is 365 days; at the due date 5 % may be out.\n\n"
        + table(head, rows)
        + "\n\n"
        + table(("one parameter is", "that is", "passed before due"), kinds)
    )


def reached_page(found: Sequence[Reached]) -> str:
    """Markdown: whether 10 % is 10 %."""
    rows = [("**all**", str(before(found)))]
    rows += [(kind, str(before([one for one in found if one.kind == kind]))) for kind in KINDS]
    return (
        "## Is 10 % ten percent?\n\n"
        "How often the tolerance was passed before *reach 90*, where a date within twelve years was stated, of types "
        "in which all kinds are alike; steps and late ramps began two sessions back or more.\n\n"
        + table(("the parameter", "passed before reach 90"), rows)
    )
