"""``python -m benchmarks.study.open_world --sessions 12 --seed 1 [PART…]`` writes docs/diagnosis/open-world.md.

Beyond the catalogue and the assumptions: a cause left out, noise wrongly stated or unlike normal noise, probabilities
as stated, few readings, blocks turned between sessions, parity checks of moving blocks, steps that
sensors share. Of a page that exists, a part can be made anew by itself; each part says what made it.
"""

import argparse
import os
import sys
from collections.abc import Callable, Iterable
from concurrent.futures import Executor, ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import TypeVar

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from benchmarks.details import in_full, publish, published
from benchmarks.study import (
    degrees_of_freedom,
    examine,
    left_out,
    other_noise,
    parity_reach,
    reliability,
    shared_steps,
    stated_noise,
    turns,
)
from tests.blind.catalogue import CATALOGUE

PAGE = Path(__file__).parents[2] / "docs" / "diagnosis" / "open-world.md"

INTRODUCTION = (
    "How the diagnosis behaves when its assumptions are false ([inside them](study.md)). Physics, flights and blocks "
    "are simulated by code that the estimator does not share. Intervals: 95 % (Wilson)."
)

Task = TypeVar("Task")
Answer = TypeVar("Answer")


def performed(pool: Executor, work: Iterable[Task], perform: Callable[[Task], Answer]) -> list[Answer]:
    """Answers in order, with a line of progress."""
    tasks, answers = list(work), list[Answer]()
    for answer in pool.map(perform, tasks, chunksize=2):
        answers.append(answer)
        print(f"\r{perform.__module__} {len(answers)}/{len(tasks)}", end="", file=sys.stderr)
    print(file=sys.stderr)
    return answers


def left_out_part(pool: Executor, sessions: int, seed: int) -> str:
    """Every cause of the catalogue left out, so many times."""
    return left_out.section(performed(pool, left_out.tasks(sessions * len(CATALOGUE), seed), examine.perform))


def stated_noise_part(pool: Executor, sessions: int, seed: int) -> str:
    """The section on stated noise, with ``sessions`` sessions of every factor."""
    return stated_noise.section(performed(pool, stated_noise.wishes(sessions, seed + 1), stated_noise.perform))


def other_noise_part(pool: Executor, sessions: int, seed: int) -> str:
    """Four times as many sessions of every kind."""
    return other_noise.section(performed(pool, other_noise.wishes(4 * sessions, seed), other_noise.perform))


def reliability_part(pool: Executor, sessions: int, seed: int) -> str:
    """Fifty times as many sessions."""
    return reliability.section(performed(pool, examine.tasks(50 * sessions, seed + 2), examine.perform))


def few_readings_part(pool: Executor, sessions: int, seed: int) -> str:
    """Ten times as many sessions of every number of readings."""
    return "## Few readings\n\n" + pool.submit(degrees_of_freedom.tables, 10 * sessions, seed).result()


def turned_part(pool: Executor, sessions: int, seed: int) -> str:
    """A third as many sessions of every programme and turn."""
    return pool.submit(turns.tables, max(sessions // 3, 1), seed).result()


def parity_part(pool: Executor, sessions: int, seed: int) -> str:
    """Five times as many flights."""
    return "## Parity checks of moving blocks\n\n" + pool.submit(parity_reach.tables, 5 * sessions, seed).result()


def shared_steps_part(pool: Executor, sessions: int, seed: int) -> str:
    """The section on shared steps, with ``sessions`` sessions of every number of sensors and strength."""
    return shared_steps.section(performed(pool, shared_steps.wishes(sessions, seed), shared_steps.perform))


PARTS: dict[str, Callable[[Executor, int, int], str]] = {
    "left-out": left_out_part,
    "stated-noise": stated_noise_part,
    "other-noise": other_noise_part,
    "reliability": reliability_part,
    "few-readings": few_readings_part,
    "turned": turned_part,
    "parity": parity_part,
    "shared-steps": shared_steps_part,
}
"""The parts in the order of the page; each begins with its heading."""


def with_command(part: str, command: str) -> str:
    """The part with what made it below its heading."""
    heading, rest = part.split("\n", 1)
    return f"{heading}\n\n{in_full(f'Made by `{command}`.')}\n{rest}"


def parts_of(page: str) -> dict[str, str]:
    """The parts of a page by their headings."""
    found = ["## " + text.rstrip() for text in page.split("\n## ")[1:]]
    return {part.split("\n", 1)[0]: part for part in found}


def main() -> None:
    """Run the study, or parts of it, and write its page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.study.open_world", description=__doc__)
    parser.add_argument("parts", nargs="*", metavar="PART", help="only these: " + ", ".join(PARTS))
    parser.add_argument("--sessions", type=int, default=12)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--out", type=Path, default=PAGE)
    options = parser.parse_args()
    if unknown := set(options.parts) - set(PARTS):
        parser.error(f"no such part: {', '.join(sorted(unknown))}; choose from {', '.join(PARTS)}")
    kept = parts_of(published(options.out)) if options.parts else {}
    size = f"--sessions {options.sessions} --seed {options.seed}"
    with ProcessPoolExecutor(options.processes, mp_context=get_context("spawn")) as pool:
        for name in options.parts or PARTS:
            made = PARTS[name](pool, options.sessions, options.seed)
            part = with_command(made, f"python -m benchmarks.study.open_world {size} {name}")
            kept[part.split("\n", 1)[0]] = part.rstrip()
            publish("\n\n".join([f"# Beyond the catalogue\n\n{INTRODUCTION}", *kept.values()]) + "\n", options.out)


if __name__ == "__main__":
    main()
