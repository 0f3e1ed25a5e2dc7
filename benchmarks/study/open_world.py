"""``python -m benchmarks.study.open_world --sessions 12 --seed 1`` writes docs/diagnosis/open-world.md.

Beyond the catalogue and the assumptions: a cause left out, noise wrongly stated, probabilities as stated, few
readings, blocks turned between sessions, parity checks of moving blocks.
"""

import argparse
import os
import sys
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import TypeVar

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from benchmarks.study import degrees_of_freedom, examine, left_out, parity_reach, reliability, stated_noise, turns
from tests.blind.catalogue import CATALOGUE

PAGE = Path(__file__).parents[2] / "docs" / "diagnosis" / "open-world.md"

INTRODUCTION = (
    "Inside its assumptions the diagnosis is measured in [study.md](study.md). Here its assumptions are false, and "
    "what counts is that it notices. Physics, flights and blocks are simulated by code that the estimator does not "
    "share. Intervals: 95 % (Wilson)."
)

Task, Answer = TypeVar("Task"), TypeVar("Answer")


def performed(pool: Executor, work: Iterable[Task], perform: Callable[[Task], Answer]) -> list[Answer]:
    """Answers in order, with a line of progress."""
    tasks, answers = list(work), list[Answer]()
    for answer in pool.map(perform, tasks, chunksize=2):
        answers.append(answer)
        print(f"\r{perform.__module__} {len(answers)}/{len(tasks)}", end="", file=sys.stderr)
    print(file=sys.stderr)
    return answers


def sections(sessions: int, seed: int, processes: int) -> Iterator[str]:
    """Every part of the page; ``sessions`` of every kind that a part tells apart."""
    with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool:
        few = pool.submit(degrees_of_freedom.tables, 10 * sessions, seed)
        turned = pool.submit(turns.tables, max(sessions // 3, 1), seed)
        moving = pool.submit(parity_reach.tables, 5 * sessions, seed)
        hidden = left_out.tasks(sessions * len(CATALOGUE), seed)
        yield left_out.section(performed(pool, hidden, examine.perform))
        yield stated_noise.section(performed(pool, stated_noise.wishes(sessions, seed + 1), stated_noise.perform))
        yield reliability.section(performed(pool, examine.tasks(50 * sessions, seed + 2), examine.perform))
        yield "## Few readings\n\n" + few.result()
        yield turned.result()
        yield "## Parity checks of moving blocks\n\n" + moving.result()


def main() -> None:
    """Run the study and write its page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.study.open_world", description=__doc__)
    parser.add_argument("--sessions", type=int, default=12)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--out", type=Path, default=PAGE)
    options = parser.parse_args()
    made = f"Made by `python -m benchmarks.study.open_world --sessions {options.sessions} --seed {options.seed}`."
    parts = [f"# Beyond the catalogue\n\n{made} {INTRODUCTION}"]
    for part in sections(options.sessions, options.seed, options.processes):
        parts.append(part)
        options.out.write_text("\n\n".join(parts) + "\n")
    print(options.out.read_text())


if __name__ == "__main__":
    main()
