"""``python -m benchmarks.shared_causes [PART…]`` writes docs/diagnosis/shared-causes.md.

Parts measure what no other command does, and each is kept until it is measured again; the other lines are read from the
pages of `benchmarks.shared`, `benchmarks.temperature` and `benchmarks.rests`.
"""

import argparse
import os
import sys
from collections.abc import Callable, Iterator

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from benchmarks.details import in_full, publish, published, whole_of
from benchmarks.shared_causes.departing import departing
from benchmarks.shared_causes.gained import gained
from benchmarks.shared_causes.history import with_history
from benchmarks.shared_causes.lines import OTHERS, PAGE, head, sections
from benchmarks.shared_causes.recorded import recorded
from benchmarks.shared_causes.unlike import Line, noisier, tails
from benchmarks.study.report import table

PARTS: dict[str, Callable[[int, int], Iterator[Line]]] = {
    "recordings": recorded,
    "departing": departing,
    "tails": tails,
    "noisier": noisier,
    "gain": gained,
    "history": with_history,
}
TITLE = "Causes that sensors share: every target"
INTRODUCTION = (
    "What is asked of causes that sensors share, of errors with tails, of unequal noise and of temperature, with what "
    "is measured. Intervals: 95 % (Wilson); a target is *missed* where the interval excludes it, and *open* where only "
    "the rate itself is beyond it; the number is that of [the reason](#why)."
)


def main() -> None:
    """Measure some parts and write the page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.shared_causes", description=__doc__)
    parser.add_argument("parts", nargs="*", help="none for all, or some of: page, " + ", ".join(PARTS))
    parser.add_argument("--sessions", type=int, default=30, help="of each kind")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    kept = sections(published(PAGE)) if whole_of(PAGE).exists() else {}
    for part in options.parts or PARTS:
        if part == "page":
            continue
        lines = []
        for line in PARTS[part](options.sessions, options.seed):
            lines.append(line)
            print(" | ".join(line), file=sys.stderr, flush=True)
        command = f"python -m benchmarks.shared_causes {part} --sessions {options.sessions} --seed {options.seed}"
        kept[part] = f"Made by `{command}`.\n\n{table(('', 'target', 'measured'), lines)}"
        publish(page(kept), PAGE)
    publish(page(kept), PAGE)
    print(head(kept))


def page(kept: dict[str, str]) -> str:
    """Markdown."""
    own = "\n\n".join(f"## {part}\n\n{kept[part]}" for part in PARTS if part in kept)
    others = ", ".join(f"[{name}]({path})" for name, path in OTHERS.items())
    return (
        f"# {TITLE}\n\nMade by `python -m benchmarks.shared_causes`. {INTRODUCTION}\n\n{head(kept)}\n\n"
        f"Lines of other commands, with all their tables: {others}.\n\n{in_full(own)}\n"
    )


if __name__ == "__main__":
    main()
