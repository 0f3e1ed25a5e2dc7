"""Tests whether units come back in time and not too early, and whether stated dates hold, in types of many sizes."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.backtest.histories import History
from benchmarks.backtest.knowing import early
from benchmarks.backtest.units import PARAMETERS, Unit, learned, outlook, track, unit
from benchmarks.backtest.worlds import World
from benchmarks.study.rates import Rate, rate
from benchmarks.study.report import table
from estimator.health.forecast import AHEAD, EARLY, RISK_LEVEL, reach
from estimator.health.pooled import Prior
from estimator.health.prognosis import prognosis

LONGEST = 1.0
"""Years; the longest interval of the unit type."""
DATED = (6, 14)
"""Sessions of units whose stated dates are looked at."""
SINCE = 2
"""Sessions since the onset, at least, of parameters that are looked at by what they do."""
LATE = 10
"""Added of one kind to every type."""
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
    early: tuple[float, ...]
    """Dates by the estimator and by its rivals; in the back-test, given the generator's laws."""
    passed: float
    is_found: bool
    """Whether a change was found in it."""
    since: int
    """Sessions from the onset of what it does on; all where it does so from the start."""
    is_more: bool
    """Whether it is one of the histories added of a single kind."""


def dues(world: World, types: int, rng: np.random.Generator) -> list[Due]:
    """Due dates of types of twenty units, so many for every number of sessions; units already out are left out."""
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
    """Stated dates of types whose parameters are of all kinds alike, with onsets on any day: three units of each kind,
    and more of the drift that begins some day, for its statistics, begun two sessions back or more.
    """
    found, late = list[Reached](), world.planned(DATED, since=SINCE)
    for _ in range(types):
        units = [mixed(world, i, rng) for i in range(3 * len(world.kinds))]
        prior = learned(units)
        ones = [(unit.parameters[0], False) for unit in units]
        ones += [(world.made(world.late, late, rng), True) for _ in range(LATE)]
        found += [_reached(one, world, (prior, is_late), rng) for one, is_late in ones if one.passed > 0]
    return found


def mixed(world: World, number: int, rng: np.random.Generator) -> Unit:
    """A unit whose parameters do each something else."""
    plan = world.planned(DATED)
    time = world.dates(plan, rng)
    kinds = [world.kinds[(number + i) % len(world.kinds)] for i in range(PARAMETERS)]
    return Unit(kinds[0], tuple(world.history(kind, time, plan, rng) for kind in kinds))


def _reached(one: History, world: World, of: tuple[Prior, bool], rng: np.random.Generator) -> Reached:
    found = prognosis([track(one)], [of[0]], np.zeros(1)).outlooks[0]
    since = int(np.sum(one.time >= one.onset))
    best = early(one, world.law, EARLY, rng)
    return Reached(one.kind, (found.reach_90, best), one.passed, bool(found.changes), since, of[1])


def before(found: Sequence[Reached], whose: int = 0) -> Rate:
    """Rate at which the tolerance was passed before the date, where one within the horizon was stated."""
    horizon = float(AHEAD[-1])
    return rate([one.passed < one.early[whose] for one in found if one.early[whose] < horizon])


def of_mix(found: Sequence[Reached]) -> list[Reached]:
    """The dates of the types as they are."""
    return [one for one in found if not one.is_more]


def of_kind(world: World, kind: str, found: Sequence[Reached]) -> list[Reached]:
    """The dates of one kind whose onset lies two sessions back or more."""
    return [one for one in found if one.kind == kind and one.since >= SINCE and one.is_more == (kind == world.late)]


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
        of_name = [one for one in found if one.known == name]
        days = [365 * one.due for one in of_name if one.kind == world.still]
        rows.append((name, f"{np.median(days):.0f}", str(rate([one.passed < one.due for one in of_name]))))
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
    groups = {"**all**": of_mix(found), **{kind: of_kind(world, kind, found) for kind in world.kinds}}
    rows = [
        (
            name,
            str(before(members)),
            str(before([one for one in members if one.is_found])),
            str(before(members, whose=1)),
        )
        for name, members in groups.items()
    ]
    return (
        "### Is 10 % ten percent?\n\n"
        "How often the tolerance was passed before *reach 90*, where a date within twelve years was stated, in types "
        "with all kinds equally common and changes at any day; by kind, those whose change began two sessions back or "
        "more. The last column is the 10 % date given the generator's laws: what exceeds a tenth there, the readings "
        "do not show.\n\n"
        + table(
            ("the parameter", "passed before reach 90", "where a change was found", "given the generator's laws"), rows
        )
    )
