"""Print docs/papers-alignment.md and draw its figures: ``python -m benchmarks.papers_alignment``; half a minute."""

import sys

from benchmarks.papers_alignment.figures import draw
from benchmarks.papers_alignment.runs import errors
from benchmarks.papers_alignment.tables import end_values, plans, prediction, rate_tables
from estimator.alignment import Model

HEAD = """# Multi-position alignment: the paper beside ours

Written by `python -m benchmarks.papers_alignment > docs/papers-alignment.md`, which draws the figures too. Source: Liu,
Jia, Li, Zhao, Dong, on gyro mounting errors in single-axis rotation multi-position alignment. The method and what goes
beyond the paper: [alignment on a turntable](methods/alignment.md)."""


def main() -> None:
    """Print all sections and write both figures."""
    ten, turntable = errors(Model.TEN), errors(Model.TURNTABLE)
    draw(ten, turntable)
    parts = (HEAD, end_values(ten, turntable), prediction(), plans(), rate_tables())
    sys.stdout.write("\n\n".join(parts) + "\n")


if __name__ == "__main__":
    main()
