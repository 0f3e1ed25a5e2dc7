"""Tests whether stated dates hold at any time of a unit's life, on three generators:
benchmarks/results/health/dates.md.
"""

import argparse
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from benchmarks.backtest.forecasts import LONGEST
from benchmarks.backtest.histories import History
from benchmarks.backtest.knowing import Law, known_passages
from benchmarks.backtest.lived import DESCRIBED, lived, lives
from benchmarks.backtest.units import PARAMETERS, Unit, learned, outlook, track
from benchmarks.backtest.worlds import FIRST, SECOND, World
from benchmarks.details import RESULTS
from benchmarks.study.rates import Rate, rate
from benchmarks.study.report import table
from estimator.health.forecast import AHEAD, RISK_LEVEL, reach
from estimator.health.prognosis import prognosis
from estimator.session import Array

PAGE = RESULTS / "health" / "dates.md"
MIXED = 12
"""Units of a type in whose parameters all kinds are alike."""
FLEET = 20
"""Units of a type in which one parameter of some does something."""
BAD = {"one in five": 0.2, "one in fifty": 0.02}
"""Shares of units of which one parameter is not stable."""
ALIKE = "all kinds alike"
DUE_HEAD = ("generator", "units that are not stable", "passed before due", "days to due of stable ones: 10 %", "median")
HORIZONS = np.array([1.0, 2.0, 4.0, 8.0])
"""Years within which chances are held against what came."""
BINS = (0.0, 0.05, 0.15, 0.35, 0.65, 0.85, 1.0)
"""Bins of stated chances."""
Random = np.random.Generator


@dataclass(frozen=True)
class Source:
    """A generator, as statements ask for it."""

    name: str
    kinds: tuple[str, ...]
    """Kinds of histories; nothing moves in the first."""
    units: Callable[[list[tuple[str, ...]], Random], list[tuple[History, ...]]]
    """Parameters of units, each of a kind."""
    law: Law | None
    """The generator's laws, for somebody who knows them; None where they are not written down."""


@dataclass(frozen=True)
class Statement:
    """Two dates of one parameter, in years from its last session, and what came."""

    kind: str
    sessions: int
    reach_90: float
    reach_50: float
    chances: Array
    """(h,) chances that the tolerance is passed within `HORIZONS`, for a parameter that is within it now."""
    known: float | None
    """The chance that the tolerance is passed by the second date, by somebody who knows the generator; None where
    nobody does, or none is stated."""
    passed: float


@dataclass(frozen=True)
class Sample:
    """Numbers drawn of every generator."""

    types: int = 8
    fleets: int = 1


def of_world(name: str, world: World) -> Source:
    """One of the generators of the back-test."""

    def units(kinds: list[tuple[str, ...]], rng: Random) -> list[tuple[History, ...]]:
        plan, found = world.planned((6, 14)), []
        for of_unit in kinds:
            time = world.dates(plan, rng)
            found.append(tuple(world.history(kind, time, plan, rng) for kind in of_unit))
        return found

    return Source(name, world.kinds, units, world.law)


def of_lives(name: str) -> Source:
    """The generator of units' lives."""

    def units(kinds: list[tuple[str, ...]], rng: Random) -> list[tuple[History, ...]]:
        return [lived(life, of_unit, rng) for life, of_unit in zip(lives(len(kinds), rng), kinds, strict=True)]

    return Source(name, tuple(DESCRIBED), units, None)


SOURCES = (of_world("steady workshops", FIRST), of_world("uneven workshops", SECOND), of_lives("units' lives"))


def today(units: Iterable[tuple[History, ...]], rng: Random) -> list[Unit]:
    """Every unit as it is known after some session of its life, the second or a later one."""
    return [
        Unit(histories[0].kind, _until(histories, int(rng.integers(2, len(histories[0].time) + 1))))
        for histories in units
    ]


def _until(histories: tuple[History, ...], n: int) -> tuple[History, ...]:
    parts = ("time", "value", "sigma", "temperature")
    return tuple(replace(one, **{name: getattr(one, name)[:n] for name in parts}) for one in histories)


def statements(source: Source, sample: Sample, rng: Random) -> list[Statement]:
    """The statements on all parameters of types in which all kinds are alike; those out of tolerance already are left
    out.
    """
    found = list[Statement]()
    for _ in range(sample.types):
        kinds = [tuple(source.kinds[(i + j) % len(source.kinds)] for j in range(PARAMETERS)) for i in range(MIXED)]
        units = today(source.units(kinds, rng), rng)
        prior = learned(units)
        for one in (one for unit in units for one in unit.parameters if one.passed > 0):
            stated = prognosis([track(one)], [prior], np.zeros(1)).outlooks[0]
            dates = (stated.reach_90, stated.reach_50)
            known = None if source.law is None else _believed(one, source.law, stated.reach_50, rng)
            found.append(Statement(one.kind, len(one.time), *dates, _within(stated.chance), known, one.passed))
    return found


def _within(chance: Array) -> Array:
    """(h,) chances by `HORIZONS`, from those at `AHEAD`, given that the parameter is within its tolerance now."""
    now = float(chance[0])
    return np.asarray((np.interp(HORIZONS, AHEAD, chance) - now) / max(1 - now, 1e-9))


def _believed(one: History, law: Law, date: float, rng: Random) -> float | None:
    """Chance of passing by a date, for somebody who knows the generator; None for a date beyond the horizon, or
    readings that rule out a value within the tolerance.
    """
    passages = known_passages(one, law, rng) if date < AHEAD[-1] else np.zeros(0)
    return float(np.mean(passages <= date)) if len(passages) else None


def held(found: Iterable[Statement], date: Callable[[Statement], float]) -> Rate:
    """Rate at which the tolerance was passed by a date, where one within the horizon was stated."""
    horizon = float(AHEAD[-1])
    return rate([one.passed <= date(one) for one in found if date(one) < horizon])


@dataclass(frozen=True)
class Come:
    """One unit of a fleet, years from its last session."""

    kind: str
    sessions: int
    due: float
    passed: float


def fleets(source: Source, share: float | None, sample: Sample, rng: Random) -> Iterator[Come]:
    """Due dates of units of which a share is not stable, or all kinds alike; units that are out are left out."""
    still, others = source.kinds[0], source.kinds[1:]
    for _ in range(sample.fleets):
        if share is None:
            first = [source.kinds[i % len(source.kinds)] for i in range(FLEET)]
        else:
            first = [str(rng.choice(others)) if rng.random() < share else still for _ in range(FLEET)]
        units = today(source.units([(kind, *[still] * (PARAMETERS - 1)) for kind in first], rng), rng)
        prior = learned(units)
        for one in units:
            due = min(float(reach(outlook(one, prior).risk[None], RISK_LEVEL)[0]), LONGEST)
            if one.passed > 0 and due > 0:
                yield Come(one.kind, len(one.parameters[0].time), due, one.passed)


def page(sample: Sample, seed: int) -> str:
    """Markdown."""
    short, kinds, chances, came = [], list[str](), [], []
    for number, source in enumerate(SOURCES):
        found = statements(source, sample, np.random.default_rng([seed, number, 1]))
        short.append(_short(source, found))
        chances += [_as_stated(source.name, h, found) for h in range(len(HORIZONS))]
        kinds += [f"### {source.name[0].upper()}{source.name[1:]}", _by_kind(source, found)]
        for i, (name, share) in enumerate(((ALIKE, None), *BAD.items())):
            came.append(
                _come(source, name, list(fleets(source, share, sample, np.random.default_rng([seed, number, 2 + i]))))
            )
    head = ("generator", "by reach 90", "by reach 50", "by reach 50, given the generator's laws")
    parts = [
        "# Do stated dates hold?",
        f"Made by `python -m benchmarks.backtest.dates --seed {seed}`. A session of every unit's life, the second or a "
        "later one, is drawn and its statements compared with what follows. The first two generators are those of the "
        "[back-test](backtest.md), the third that of `tests/lives/generator`; none shares a law with another or with "
        "the estimator. Intervals: 95 % (Wilson). [What is computed](../../../docs/methods/health.md).",
        "## Dates of parameters",
        f"Types of {MIXED} units with all kinds equally common in their {PARAMETERS} parameters: how often the "
        "tolerance was passed by a date stated within twelve years. Target: 7 to 13 % by *reach 90*, 42 to 58 % by "
        "*reach 50*. The last column is the mean chance, with two standard errors, given the generator's laws.",
        table(head, short),
        "*Reach 50* is early for saturating aging, which the readings cannot separate from continuing aging; the "
        "generator's laws give those dates less than 50 % too. Early is the safe side.",
        "## Are chances right?",
        "How often the tolerance was passed within so many years, by the chance that was stated for it.",
        table(("generator", "within", *(f"{low:.0%} to {high:.0%}" for low, high in pairwise(BINS))), chances),
        *kinds,
        "## Due dates of units",
        f"Types of {FLEET} units; of some one parameter in {PARAMETERS} is not stable. Wanted: 5 % at most pass before "
        "they are due, and a median of 330 days and more for stable units from the 4th session on.",
        table(DUE_HEAD, came),
    ]
    return "\n\n".join(parts) + "\n"


def _short(source: Source, found: list[Statement]) -> tuple[str, ...]:
    known = [one.known for one in found if one.known is not None]
    early, middle = held(found, lambda one: one.reach_90), held(found, lambda one: one.reach_50)
    return source.name, str(early), str(middle), _mean(known)


def _mean(chances: list[float]) -> str:
    """The mean with two standard errors."""
    if len(chances) < 2:
        return "–"
    return f"{100 * np.mean(chances):.1f} ± {200 * np.std(chances, ddof=1) / np.sqrt(len(chances)):.1f} %"


def _as_stated(name: str, h: int, found: list[Statement]) -> tuple[str, ...]:
    """One horizon's row: of every bin of stated chances their mean, and how often it came."""
    stated = np.array([one.chances[h] for one in found])
    came = np.array([one.passed <= HORIZONS[h] for one in found])
    cells = []
    for low, high in pairwise(BINS):
        inside = (stated >= low) & ((stated < high) | (high == 1))
        mean = f"{100 * stated[inside].mean():.0f} %: " if inside.any() else ""
        cells.append(mean + str(rate(list(came[inside]))))
    return (name, f"{HORIZONS[h]:.0f} years", *cells)


def _by_kind(source: Source, found: list[Statement]) -> str:
    groups = {kind: [one for one in found if one.kind == kind] for kind in source.kinds}
    groups["second and third session"] = [one for one in found if one.sessions <= 3]
    rows = [
        (name, str(held(members, lambda one: one.reach_90)), str(held(members, lambda one: one.reach_50)))
        for name, members in groups.items()
    ]
    return table(("the parameter", "passed by reach 90", "passed by reach 50"), rows)


def _come(source: Source, name: str, found: list[Come]) -> tuple[str, ...]:
    days = [365 * one.due for one in found if one.kind == source.kinds[0] and one.sessions >= 4]
    low, middle = np.percentile(days, (10, 50)) if days else (np.nan, np.nan)
    return source.name, name, str(rate([one.passed < one.due for one in found])), f"{low:.0f}", f"{middle:.0f}"


def main() -> None:
    """The page, from fixed seeds."""
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("--seed", type=int, default=1)
    asked.add_argument("--out", type=Path, default=PAGE)
    asked.add_argument("--small", action="store_true", help="few statements: whether it runs, not what it shows")
    given = asked.parse_args()
    sample = Sample(1, 1) if given.small else Sample()
    given.out.write_text(page(sample, given.seed), encoding="utf-8")


if __name__ == "__main__":
    main()
