"""Whether units come back in time and not too early, and whether stated dates hold, in types of many sizes."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.backtest.histories import History
from benchmarks.backtest.units import PARAMETERS, Unit, learned, outlook, track, unit
from benchmarks.backtest.worlds import World
from benchmarks.study.rates import Rate, rate
from benchmarks.study.report import table
from estimator.health.forecast import AHEAD, RISK_LEVEL, reach
from estimator.health.pooled import Prior
from estimator.health.prognosis import prognosis

LONGEST = 1.0
"""Years; the longest interval of the unit type."""
DATED = (6, 14)
"""Sessions of units whose stated dates are looked at; what changes begins two sessions back or more."""
SIZED = (4, 5)
"""Sessions of units in types of many sizes."""
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
    is_found: bool
    """Whether a change was found in it."""


def dues(world: World, types: int, rng: np.random.Generator) -> list[Due]:
    """Of types of twenty units, so many for every number of sessions; units that are out already are left out."""
    rows = []
    for name, sessions in world.sessions.items():
        for _ in range(types):
            rows += _dues_of(name, [unit(world, kind, world.planned(sessions), rng) for kind in world.fleet])
    return rows


def _dues_of(name: str, units: Sequence[Unit]) -> list[Due]:
    prior = learned(units)
    return [Due(one.kind, name, due_of(one, prior), one.passed) for one in units if one.passed > 0]


def due_of(one: Unit, prior: Prior) -> float:
    """Years."""
    return min(float(reach(outlook(one, prior).risk[None], RISK_LEVEL)[0]), LONGEST)


def dates_reached(world: World, types: int, rng: np.random.Generator) -> list[Reached]:
    """Of types in which all kinds are alike, three units of each."""
    found, plan = list[Reached](), world.planned(DATED, since=2)
    for _ in range(types):
        units = [unit(world, kind, plan, rng) for kind in world.kinds * 3]
        prior = learned(units)
        found += [_reached(one.kind, one.parameters[0], prior) for one in units if one.parameters[0].passed > 0]
    return found


def _reached(kind: str, one: History, prior: Prior) -> Reached:
    found = prognosis([track(one)], [prior], np.zeros(1)).outlooks[0]
    return Reached(kind, found.reach_90, one.passed, bool(found.changes))


def before(found: Sequence[Reached]) -> Rate:
    """How often the tolerance was passed before the date, where one within the horizon was stated."""
    horizon = float(AHEAD[-1])
    return rate([one.passed < one.early for one in found if one.early < horizon])


def sizes_page(world: World, types: int, rng: np.random.Generator, sizes: Sequence[int]) -> str:
    """Markdown: a stable unit with few sessions, in types of many sizes."""
    rows = []
    for size in sizes:
        days = []
        for _ in range(types if size < max(SIZES) else 1):
            units = [unit(world, kind, world.planned(SIZED), rng) for kind in (world.fleet * 10)[:size]]
            prior = learned(units)
            days += [365 * due_of(one, prior) for one in units[:10] if one.kind == world.still]
        low, middle, high = np.percentile(days, (10, 50, 90))
        rows.append((size, len(days), f"{low:.0f}", f"{middle:.0f}", f"{high:.0f}"))
    head = ("units of the type", f"{world.still} units", "days to due: 10 %", "median", "90 %")
    return "### What a type of few units costs\n\nUnits with four to five sessions.\n\n" + table(head, rows)


def due_page(world: World, found: Sequence[Due]) -> str:
    """Markdown: when units come back."""
    rows = []
    for name in world.sessions:
        own = [one for one in found if one.known == name]
        days = [365 * one.due for one in own if one.kind == world.still]
        rows.append((name, f"{np.median(days):.0f}", str(rate([one.passed < one.due for one in own]))))
    head = ("sessions", f"days to due, {world.still} units, median", "passed before due, all units")
    kinds = [
        (kind, text, str(rate([one.passed < one.due for one in found if one.kind == kind])))
        for kind, text in world.described.items()
    ]
    return (
        "### When units come back\n\n"
        f"Types of twenty units with {PARAMETERS} parameters each; in {len(world.kinds) - 1} units one parameter does "
        "something. The "
        "longest interval is 365 days; at the due date 5 % may be out.\n\n"
        + table(head, rows)
        + "\n\n"
        + table(("one parameter is", "that is", "passed before due"), kinds)
    )


def reached_page(world: World, found: Sequence[Reached]) -> str:
    """Markdown: whether 10 % is 10 %."""
    seen = [one for one in found if one.is_found]
    rows = [("**all**", str(before(found)), str(before(seen)))]
    for kind in world.kinds:
        of_kind = ([one for one in group if one.kind == kind] for group in (found, seen))
        rows.append((kind, *(str(before(own)) for own in of_kind)))
    return (
        "### Is 10 % ten percent?\n\n"
        "How often the tolerance was passed before *reach 90*, where a date within twelve years was stated, of types "
        "in which all kinds are alike; what changes one day did so two sessions back or more.\n\n"
        + table(("the parameter", "passed before reach 90", "where a change was found"), rows)
    )
