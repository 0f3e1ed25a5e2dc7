"""Writes docs/health/backtest.md."""

import argparse
from pathlib import Path

from benchmarks.backtest.coverage import coverage_page, outcomes
from benchmarks.backtest.detection import detection_page

PAGE = Path(__file__).parents[2] / "docs" / "health" / "backtest.md"


def main() -> None:
    """The page, from fixed seeds."""
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("--histories", type=int, default=1000, help="of every kind")
    asked.add_argument("--seed", type=int, default=1)
    asked.add_argument("--out", type=Path, default=PAGE)
    given = asked.parse_args()
    parts = [
        "# Back-test of drift and forecast",
        f"Made by `python -m benchmarks.backtest --histories {given.histories} --seed {given.seed}`. Simulated "
        "deviations in tolerances T: 8 to 16 sessions at irregular dates within four years, each with a standard "
        "uncertainty of 0.03 to 0.2 T, the first of them the reference. Intervals: 95 % (Wilson). "
        "[What is computed](../methods/health.md).",
        coverage_page(outcomes(given.histories, given.seed)),
        detection_page(given.histories, given.seed),
    ]
    given.out.parent.mkdir(parents=True, exist_ok=True)
    given.out.write_text("\n\n".join(parts) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
