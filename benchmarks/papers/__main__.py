"""Every table and figure of the papers beside ours: ``make papers``, or ``python -m benchmarks.papers``.

Writes papers.md, papers-alignment.md and papers-optimisation.md in benchmarks/results, and their figures. Seeds are
fixed, so that all but the times in the last one come out the same; some minutes.
"""

import sys

from benchmarks.details import RESULTS
from benchmarks.optimisation import page as optimisation
from benchmarks.papers import analytic, schematics
from benchmarks.papers_alignment.page import page as alignment

PAGES = {"papers.md": analytic.page, "papers-alignment.md": alignment, "papers-optimisation.md": optimisation}


def main() -> None:
    """Write all pages, or those that are named."""
    schematics.draw()
    for name in sys.argv[1:] or PAGES:
        (RESULTS / name).write_text(PAGES[name](), encoding="utf-8")
        sys.stdout.write(f"benchmarks/results/{name}\n")


if __name__ == "__main__":
    main()
