"""Print docs/papers.md: ``python -m benchmarks.papers > docs/papers.md``. Fixed seeds; under half a minute."""

import sys

from benchmarks.papers.formulas import formulas
from benchmarks.papers.planning import planning
from benchmarks.papers.tables import tables

HEAD = """# The papers' tables beside ours

Written by `python -m benchmarks.papers > docs/papers.md`; every difference is explained below its table, and every
error of the print has its test in the [errata](errata.md). Source: A. V. Tyuvin, analytic alignment and calibration of
the inertial measurement unit of a strapdown inertial navigation system; six sensors in a cone of 54.7° about the head's
axis (e2² = 1/3), α = 40°, δα, δβ = 3″, θ_x, θ_y = 1″ (3σ)."""


def main() -> None:
    """Print all sections."""
    sys.stdout.write("\n\n".join((HEAD, tables(), formulas(), planning())) + "\n")


if __name__ == "__main__":
    main()
