"""``python -m benchmarks.study.seen --seed 1 [PART…]`` writes docs/diagnosis/seen.md.

A part is a module beside this one with ``table(n, seed)``; its ``TARGET``, where it has one, stands beside what was
seen. Why something was missed is written by hand below its table, between the marks, and stays when the table is made
anew.
"""

import argparse
import os
import re
from dataclasses import dataclass, replace
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from benchmarks.details import publish, published, whole_of
from benchmarks.study.open_world import parts_of, with_command

PAGE = Path(__file__).parents[3] / "docs" / "diagnosis" / "seen.md"
INTRODUCTION = (
    "Faults that careful people see at a glance are hidden in files and sessions by generators that share no code with "
    "the estimator, and what comes out is counted: found, named, refused, or taken for sound. Intervals: 95 %."
)
BEGIN, END = "<!-- why missed -->", "<!-- end of why missed -->"
WHY = re.compile(f"{BEGIN}.*?{END}", re.DOTALL)


@dataclass(frozen=True)
class Part:
    """One table of the page."""

    heading: str
    about: str
    n: int
    """Sessions of its table."""


PARTS = {
    "flights": Part(
        "A sensor that fails in service",
        "Blocks fly; in one of two flights a sensor begins to fail on the way.",
        300,
    ),
    "real_arrays": Part(
        "The same in recordings of real arrays", "Faults are put into public recordings, whose noise nobody drew.", 100
    ),
    "gross": Part(
        "A gross reading", "One reading of a session was copied wrong, or a channel hung for some rows.", 300
    ),
    "raw_files": Part(
        "What loggers do to raw files",
        "Samples of a block turned by hand, written in five formats with each of sixteen faults.",
        400,
    ),
    "bounds": Part(
        "What no sensor can do",
        "All scale factors change together, by more than gravity, latitude or a clock can do, or by what they can.",
        300,
    ),
}
"""The parts by their modules, in the order of the page."""


def made(name: str, part: Part, seed: int, why: str) -> str:
    """A part: target, table, and why something was missed."""
    module = import_module(f"benchmarks.study.seen.{name}")
    target = f" Target: {module.TARGET}" if hasattr(module, "TARGET") else ""
    return f"## {part.heading}\n\n{part.about}{target}\n\n{module.table(part.n, seed)}\n\n{why}"


def why_of(part: str) -> str:
    """The text written below a table, with its marks."""
    found = WHY.search(part)
    return found[0] if found else f"{BEGIN}\n{END}"


def page(kept: dict[str, str]) -> str:
    """The page made of the parts that there are, by heading."""
    return "\n\n".join(["# What anybody would see", INTRODUCTION, *filter(None, kept.values())]) + "\n"


def main() -> None:
    """Make the parts, and write the page after each."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.study.seen", description=__doc__)
    parser.add_argument("parts", nargs="*", metavar="PART", help="only these: " + ", ".join(PARTS))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--n", type=int, help="sessions of every part; as many as its table is asked for unless given")
    parser.add_argument("--out", type=Path, default=PAGE)
    options = parser.parse_args()
    if unknown := set(options.parts) - set(PARTS):
        parser.error(f"no such part: {', '.join(sorted(unknown))}; choose from {', '.join(PARTS)}")
    few = "" if options.n is None else f" --n {options.n}"
    before = parts_of(published(options.out)) if whole_of(options.out).exists() else {}
    kept = {PARTS[name].heading: before.get(f"## {PARTS[name].heading}", "") for name in PARTS}
    publish(page(kept), options.out)
    for name in options.parts or [name for name in PARTS if find_spec(f"benchmarks.study.seen.{name}")]:
        part = PARTS[name] if options.n is None else replace(PARTS[name], n=options.n)
        text = made(name, part, options.seed, why_of(kept[part.heading]))
        kept[part.heading] = with_command(text, f"python -m benchmarks.study.seen --seed {options.seed}{few} {name}")
        publish(page(kept), options.out)


if __name__ == "__main__":
    main()
