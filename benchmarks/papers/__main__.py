"""Every table and figure of the papers beside ours: ``make papers``, or ``python -m benchmarks.papers``.

Writes docs/papers.md, docs/papers-alignment.md and docs/papers-optimisation.md with their figures. Seeds are fixed, so
that all but the times in the last one come out the same; some minutes.
"""

import sys
from pathlib import Path

from benchmarks.details import publish
from benchmarks.optimisation import page as optimisation
from benchmarks.papers import analytic, schematics
from benchmarks.papers_alignment.page import page as alignment

DOCS = Path(__file__).parents[2] / "docs"
PAGES = {"papers.md": analytic.page, "papers-alignment.md": alignment, "papers-optimisation.md": optimisation}


def main() -> None:
    """Write all pages, or those that are named."""
    schematics.draw()
    for name in sys.argv[1:] or PAGES:
        publish(PAGES[name](), DOCS / name)
        sys.stdout.write(f"docs/{name}\n")


if __name__ == "__main__":
    main()
