"""Writes docs/health/backtest.md."""

import argparse
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from benchmarks.backtest.detection import alarms_page, beside_page, found, rivals_page, tails_of
from benchmarks.backtest.forecasts import (
    SIZES,
    Due,
    Reached,
    before,
    dates_reached,
    due_page,
    dues,
    of_kind,
    of_mix,
    reached_page,
    sizes_page,
)
from benchmarks.backtest.warmth import followed
from benchmarks.backtest.worlds import FIRST, SECOND, World
from benchmarks.details import in_full, publish
from benchmarks.study.rates import rate
from benchmarks.study.report import table
from estimator.health.error_laws import USUAL

PAGE = Path(__file__).parents[2] / "docs" / "health" / "backtest.md"
SHORT = ("figure", "here", "target")


@dataclass(frozen=True)
class Sample:
    """Numbers of histories and types that are drawn."""

    histories: int = 300
    """Histories of every kind."""
    types: int = 5
    """Types with due dates, for every number of sessions."""
    dated: int = 50
    """Types with stated dates: of a date only those that pass a tolerance tell."""
    compared: int = 1000
    """Histories of every kind beside the optimum: two parts in a hundred are distinguished from chance."""

    @property
    def smaller(self) -> "Sample":
        """A smaller sample, for the second generator."""
        return replace(
            self,
            histories=self.histories // 2,
            types=max(self.types * 2 // 3, 1),
            dated=max(self.dated * 4 // 5, 1),
        )


SMALL = Sample(6, 1, 1, 6)
Row = tuple[str, str, str]


def main() -> None:
    """The page, from fixed seeds."""
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("--small", action="store_true", help="few histories: whether it runs, not what it shows")
    asked.add_argument("--seed", type=int, default=1)
    asked.add_argument("--out", type=Path, default=PAGE)
    given = asked.parse_args()
    publish(page(SMALL if given.small else Sample(), given.seed), given.out)


def page(sample: Sample, seed: int) -> str:
    """Markdown, from so many histories and types of units."""
    parts = [
        "# Back-test of drift and forecast",
        f"Made by `python -m benchmarks.backtest --seed {seed}`. Simulated deviations in tolerances T, from two "
        "generators that share nothing with the estimator, nor with one another. Intervals: 95 % (Wilson). "
        "[What is computed](../methods/health.md).",
        *_first(sample, np.random.default_rng([seed, 1])),
        *_second(sample.smaller, np.random.default_rng([seed, 2])),
    ]
    return "\n\n".join(parts) + "\n"


def _first(sample: Sample, rng: np.random.Generator) -> list[str]:
    """The generator that the optimum knows."""
    count = sample.histories
    rivals, beside = rivals_page(sample.compared, rng)
    tails = tails_of(FIRST, rng)
    due, reached = dues(FIRST, sample.types, rng), dates_reached(FIRST, sample.dated, rng)
    hits = {kind: str(rate(found(kind, count, tails, rng))) for kind in ("step", "ramp", "aging")}
    seasonal, still = followed("seasonal", count, rng), followed("stable", 2 * sample.compared, rng)
    rows = [
        ("step of one parameter found, 5 % over its unit", hits["step"], "≥ 98 %"),
        ("the same, where nothing is known of the tails of errors", str(rate(found("step", count, USUAL, rng))), "–"),
        ("ramp found", hits["ramp"], "≥ 95 %"),
        ("aging found", hits["aging"], "≥ 95 %"),
        *_dates(FIRST, due, reached),
        ("temperature coefficient found at 1 %, seasonal", str(rate([f.here for f in seasonal])), "≥ 95 %"),
        ("the same, given that nothing else moves", str(rate([f.best for f in seasonal])), "–"),
        ("temperature coefficient found, stable", str(rate([f.here for f in still])), "≤ 1 %"),
    ]
    optimum = [
        (f"{kind}: found at equal false alarms; by the odds behind it; the optimum", str(every), "within 2")
        for kind, every in beside.items()
    ]
    return [
        "## Steady workshops",
        "Sessions every one to eight months, each with a standard uncertainty of 0.02 to 0.2 T and a normal error, the "
        "first of them the reference. Sizes are uniform, changes are sharp.",
        *_described(FIRST, rows),
        in_full(
            "\n\n".join(
                [
                    table(SHORT, optimum),
                    alarms_page(FIRST, (2 * count, tails), rng),
                    rivals,
                    *_forecasts(FIRST, sample.types, rng, (due, reached)),
                ]
            )
        ),
    ]


def _second(sample: Sample, rng: np.random.Generator) -> list[str]:
    """The generator that no rule knows."""
    count = sample.histories
    due, reached = dues(SECOND, sample.types, rng), dates_reached(SECOND, sample.dated, rng)
    return [
        "## Uneven workshops",
        "Three to sixty sessions, in campaigns with long gaps between them, each with a standard uncertainty of 0.01 "
        "to 0.3 T and an error with heavy tails (Student's, four degrees of freedom). Sizes are log-normal over a "
        "decade, onsets follow a hazard.",
        *_described(SECOND, _dates(SECOND, due, reached)),
        in_full(
            "\n\n".join(
                [
                    alarms_page(SECOND, (2 * count, tails_of(SECOND, rng)), rng),
                    beside_page(SECOND, count, rng),
                    *_forecasts(SECOND, sample.types, rng, (due, reached)),
                ]
            )
        ),
    ]


def _described(world: World, rows: Sequence[Row]) -> list[str]:
    kinds = table(("a parameter may be", "that is"), list(world.described.items()))
    return [in_full(kinds), "### In short", table(SHORT, list(rows))]


def _dates(world: World, due: Sequence[Due], reached: Sequence[Reached]) -> list[Row]:
    """Rows on due dates and stated dates."""
    known = list(world.sessions)[1:]
    days = float(np.median([365 * d.due for d in due if d.kind == world.still and d.known in known]))
    late = of_kind(world, world.late, reached)
    return [
        (f"days to due, {world.still} unit of a type of 20, from the 4th session, median", f"{days:.0f}", "≥ 330"),
        ("passed the tolerance before due, all units", str(rate([d.passed < d.due for d in due])), "≤ 5 %"),
        ("passed before reach 90, all kinds alike", str(before(of_mix(reached))), "7–13 %"),
        (f"passed before reach 90, {world.late} since two sessions or more", str(before(late)), "≤ 20 %"),
        ("the same, given the generator's laws", str(before(late, whose=1)), "–"),
    ]


def _forecasts(
    world: World, types: int, rng: np.random.Generator, found: tuple[Sequence[Due], Sequence[Reached]]
) -> list[str]:
    sizes = SIZES if types > 1 else SIZES[:2]
    return [due_page(world, found[0]), sizes_page(world, types, rng, sizes), reached_page(world, found[1])]


if __name__ == "__main__":
    main()
