"""Cases drawn and diagnosed, in as many processes as the machine has."""

from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from itertools import cycle
from multiprocessing import get_context

import numpy as np

from tests.blind.cases import draw_case
from tests.blind.catalogue import CATALOGUE, DISCRETE
from tests.blind.examine import examine
from tests.blind.score import Outcome

SHARES = {"single": 0.56, "weak": 0.08, "none": 0.16, "outside": 0.1, "two": 0.1}
"""Shares of the kinds of session in a study."""


@dataclass(frozen=True)
class Task:
    """One case to be drawn."""

    kind: str
    seed: tuple[int, ...]
    cause: str | None
    dump: str | None = None
    """Folder for the files of a case that went wrong."""


def tasks(
    sessions: int, seed: int, dump: str | None = None, kind: str | None = None, cause: str | None = None
) -> list[Task]:
    """The whole catalogue in turn, with the other kinds strewn among it; or one kind or cause only."""
    kinds = list(np.random.default_rng(seed).choice(list(SHARES), size=sessions, p=list(SHARES.values())))
    if kind or cause:
        kinds = [kind or "single"] * sessions
    scaled = [name for name in CATALOGUE if name not in DISCRETE]
    turns = {"single": cycle([cause] if cause else CATALOGUE), "weak": cycle([cause] if cause else scaled)}
    return [Task(str(k), (seed, i), next(turns[k]) if k in turns else cause, dump) for i, k in enumerate(kinds)]


def perform(task: Task) -> Outcome:
    """Draw, diagnose, mark."""
    return examine(draw_case(task.kind, task.seed, task.cause), task.dump)


def run(work: list[Task], processes: int) -> Iterator[Outcome]:
    """Outcomes in order."""
    if processes == 1:
        yield from map(perform, work)
        return
    with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool:
        yield from pool.map(perform, work, chunksize=2)
