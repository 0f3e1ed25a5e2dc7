"""Writes docs/health/backtest.md."""

import argparse
from pathlib import Path

import numpy as np

from benchmarks.backtest.detection import alarms_page, found, rivals_page
from benchmarks.backtest.forecasts import SIZES, before, dates_reached, due_page, dues, reached_page, sizes_page
from benchmarks.backtest.histories import DESCRIBED
from benchmarks.backtest.warmth import followed
from benchmarks.study.rates import rate
from benchmarks.study.report import table

PAGE = Path(__file__).parents[2] / "docs" / "health" / "backtest.md"
HISTORIES, TYPES = 500, 6
"""Of every kind; of every number of sessions."""
SMALL_HISTORIES, SMALL_TYPES = 10, 1


def main() -> None:
    """The page, from fixed seeds."""
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("--small", action="store_true", help="few histories: whether it runs, not what it shows")
    asked.add_argument("--seed", type=int, default=1)
    asked.add_argument("--out", type=Path, default=PAGE)
    given = asked.parse_args()
    count, types = (SMALL_HISTORIES, SMALL_TYPES) if given.small else (HISTORIES, TYPES)
    given.out.parent.mkdir(parents=True, exist_ok=True)
    given.out.write_text(page(count, types, given.seed), encoding="utf-8")


def page(count: int, types: int, seed: int) -> str:
    """Markdown, from ``count`` histories of a kind and ``types`` types of units."""
    rng = np.random.default_rng(seed)
    rivals, shares = rivals_page(count, rng)
    due, reached = dues(types, rng), dates_reached(4 * types, rng)
    hits = {kind: str(rate(found(kind, count, rng))) for kind in ("step", "ramp", "aging")}
    seasonal = followed("seasonal", count, rng)
    rows = [
        ("step of one parameter found, 5 % over its unit", hits["step"], "≥ 98 %"),
        ("ramp found", hits["ramp"], "≥ 95 %"),
        ("aging found", hits["aging"], "≥ 95 %"),
        *((f"{kind}: found at equal false alarms, the optimum", f"{100 * own:.1f} %, {100 * best:.1f} %", "within 2")
          for kind, (own, best) in shares.items()),
        ("days to due, stable unit of a type of 20, from the 4th session, median",
         f"{365 * float(np.median([d.due for d in due if d.kind == 'stable' and d.known != '2 to 3'])):.0f}", "≥ 330"),
        ("passed the tolerance before due, all units", str(rate([d.passed < d.due for d in due])), "≤ 5 %"),
        ("passed before reach 90, all kinds alike", str(before(reached)), "7–13 %"),
        ("passed before reach 90, late ramp", str(before([r for r in reached if r.kind == "late ramp"])), "≤ 20 %"),
        ("temperature coefficient found at 1 %, seasonal", str(rate([f.here for f in seasonal])), "≥ 95 %"),
        ("the same, by who knows that nothing else moves", str(rate([f.best for f in seasonal])), "–"),
        ("temperature coefficient found, stable", str(rate([f.here for f in followed("stable", count, rng)])), "≤ 1 %"),
    ]  # fmt: skip
    kinds = [(kind, text) for kind, text in DESCRIBED.items()]
    parts = [
        "# Back-test of drift and forecast",
        f"Made by `python -m benchmarks.backtest --seed {seed}`. Simulated deviations in tolerances T, from a "
        "generator that shares nothing with the estimator: sessions every one to eight months, each with a standard "
        "uncertainty of 0.02 to 0.2 T, the first of them the reference. Intervals: 95 % (Wilson). "
        "[What is computed](../methods/health.md).",
        table(("a parameter may be", "that is"), kinds),
        "## In short",
        table(("figure", "here", "wanted"), rows),
        alarms_page(2 * count, rng),
        rivals,
        due_page(due),
        sizes_page(types, rng, SIZES if types > 1 else SIZES[:2]),
        reached_page(reached),
    ]
    return "\n\n".join(parts) + "\n"


if __name__ == "__main__":
    main()
