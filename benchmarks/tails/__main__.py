"""Writes benchmarks/results/health/tails.md: ``python -m benchmarks.tails``."""

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.backtest.forecasts import Due, Reached, before, dues, of_kind, of_mix
from benchmarks.backtest.worlds import FIRST, SECOND, World
from benchmarks.details import RESULTS
from benchmarks.study.rates import rate
from benchmarks.study.report import table
from benchmarks.tails.forecasts import Told, missed, surprised, tailed, told

PAGE = RESULTS / "health" / "tails.md"
FREEDOM = 4.0
"""Degrees of freedom of Student's law: one error in two hundred is beyond four of its standard deviations."""
NAMES = ("errors taken for normal", "sessions weighed", "weighed, λ missing")
SHORT = 12
"""Types with stated dates for one with due dates, of every number of sessions."""


@dataclass(frozen=True)
class Case:
    """Results of one generator with one law of errors."""

    world: World
    name: str
    told: Sequence[Told]
    dues: Sequence[Due]

    @property
    def dates(self) -> list[Reached]:
        """Dates of all histories."""
        return [one.dates for one in self.told]


def main() -> None:
    """The page, from fixed seeds."""
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("--types", type=int, default=24)
    asked.add_argument("--seed", type=int, default=31)
    asked.add_argument("--out", type=Path, default=PAGE)
    given = asked.parse_args()
    given.out.write_text(page(given.types, given.seed), encoding="utf-8")


def page(types: int, seed: int) -> str:
    """Markdown."""
    cases = [
        _case(world, name, freedom, (types, np.random.default_rng([seed, i, j])))
        for i, (world, name) in enumerate(((FIRST, "steady"), (SECOND, "uneven")))
        for j, freedom in enumerate((np.inf, FREEDOM))
    ]
    parts = [
        "# Forecasts where errors have tails",
        f"Made by `python -m benchmarks.tails --types {types} --seed {seed}`. The two generators of the "
        "[back-test](backtest.md), each with normal errors and with Student's of four degrees of freedom and the same "
        f"stated standard deviation; {types} types each. Forecasts take errors for normal. Intervals: 95 % (Wilson). "
        "[What is computed](../../../docs/methods/health.md).",
        "## Do the claims suffer?",
        table(
            ("workshops, errors", "passed before reach 90, all kinds alike", "late drift, since two sessions or more",
             "days to due, still units, from the 4th session: 10 %, median", "passed before due, all units"),
            [_claims(case) for case in cases],
        ),
        "\n\n".join(["## By kind of history", *(_kinds(cases[i], cases[i + 1]) for i in (0, 2))]),
        "## Would it help to weigh sessions by Student's law?",
        "The same histories with Student's errors. *Sessions weighed*: by the type's learned tails (expectation "
        "maximisation, two rounds). *λ missing*: with the smaller information of Student's law. A level is the "
        "estimate at the last session.",
        table(
            ("workshops", "forecast", "passed before reach 90, all kinds alike",
             "late drift, since two sessions or more", "level wrong by, median", "level further out than 2 u"),
            [row for case in (cases[1], cases[3]) for row in _rivals(case)],
        ),
        "What follows from it: [errors with tails](../../../docs/methods/health.md#errors-with-tails).",
    ]  # fmt: skip
    return "\n\n".join(parts) + "\n"


def _case(world: World, name: str, freedom: float, of: tuple[int, np.random.Generator]) -> Case:
    types, rng = of
    given = tailed(world, freedom)
    label = f"{name}, {'normal' if np.isinf(freedom) else 'Student’s'}"
    return Case(given, label, told(given, types, rng), dues(given, max(types // SHORT, 1), rng))


def _claims(case: Case) -> tuple[str, ...]:
    known = list(case.world.sessions)[1:]
    days = [365 * d.due for d in case.dues if d.kind == case.world.still and d.known in known]
    low, middle = np.percentile(days, (10, 50))
    late = of_kind(case.world, case.world.late, case.dates)
    out = rate([d.passed < d.due for d in case.dues])
    return case.name, str(before(of_mix(case.dates))), str(before(late)), f"{low:.0f}, {middle:.0f}", str(out)


def _kinds(normal: Case, tails: Case) -> str:
    rows = [
        (kind, *(str(before(of_kind(case.world, kind, case.dates))) for case in (normal, tails)))
        for kind in normal.world.kinds
    ]
    return table(("the parameter", normal.name, tails.name), rows)


def _rivals(case: Case) -> list[tuple[str, ...]]:
    late = of_kind(case.world, case.world.late, case.dates)
    return [
        (
            case.name, name, str(before(of_mix(case.dates), whose)), str(before(late, whose)),
            f"{missed(case.told, whose):.3f} T", str(rate(surprised(case.told, whose))),
        )
        for whose, name in enumerate(NAMES)
    ]  # fmt: skip


if __name__ == "__main__":
    main()
