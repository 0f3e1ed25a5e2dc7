"""``python -m benchmarks.diagnosed_recordings [NAME…]`` writes docs/diagnosis/recordings.md and a page a recording."""

import argparse
import os
import sys
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from benchmarks.diagnosed_recordings.pages import STATED, index, page, stated_page
from benchmarks.diagnosed_recordings.subjects import PAGES, diagnosed
from benchmarks.recordings.sets import FOLDER, folder

DOCS = Path(__file__).parents[2] / "docs" / "diagnosis"
ALL = (*PAGES, STATED)


def main() -> int:
    """Write the pages; the index only when all of them are made."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.diagnosed_recordings", description=__doc__)
    parser.add_argument("names", nargs="*", help="only these: " + ", ".join(ALL))
    parser.add_argument("--out", type=Path, default=DOCS)
    options = parser.parse_args()
    if not folder().is_dir():
        print(f"The recordings are not at {folder()}; set {FOLDER} to their folder.", file=sys.stderr)
        return 1
    unknown = sorted(set(options.names) - set(ALL))
    if unknown:
        parser.error(f"no such recording: {', '.join(unknown)}; choose from {', '.join(ALL)}")
    made = {}
    for name in options.names or ALL:
        if name == STATED:
            stated_page(options.out / "recordings")
        else:
            made[name] = diagnosed(name)
            page(name, made[name], options.out / "recordings")
        print(name, file=sys.stderr)
    if len(made) == len(PAGES):
        (options.out / "recordings.md").write_text(index(made), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
