"""Cases drawn and diagnosed, in as many processes as the machine has."""

import json
import time
from collections.abc import Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from itertools import cycle
from multiprocessing import get_context
from pathlib import Path

import numpy as np

from estimator import diagnose, read_session
from tests.blind.cases import Case, draw_case
from tests.blind.catalogue import CATALOGUE, DISCRETE
from tests.blind.score import Outcome, score

SHARES = {"single": 0.56, "weak": 0.08, "none": 0.16, "outside": 0.1, "two": 0.1}
"""Of the sessions of a study."""


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
    return [Task(str(k), (seed, i), next(turns[k]) if k in turns else None, dump) for i, k in enumerate(kinds)]


def examine(task: Task) -> Outcome:
    """Draw, diagnose, mark."""
    case = draw_case(task.kind, task.seed, task.cause)
    start = time.perf_counter()
    found = _diagnosed(case)
    outcome = score(case, found, time.perf_counter() - start)
    if task.dump and not outcome.good:
        _dump(Path(task.dump), outcome, case.session, case.history, found)
    return outcome


def _diagnosed(case: Case) -> dict:
    """What the diagnosis says; a failure of the numerics counts as a wrong name and goes on."""
    try:
        session = read_session(case.session)
        return diagnose(session, history=[read_session(h) for h in case.history]).to_dict()
    except (ArithmeticError, ValueError) as error:
        wrong = {"cause": f"failure: {error}", "sensors": [], "alternatives": []}
        return {"findings": [wrong], "unexplained": False}


def _dump(folder: Path, outcome: Outcome, session: dict, history: list[dict], found: dict) -> None:
    """The session, its history, what was found and the truth, as files."""
    name = f"{'+'.join(outcome.causes) or 'none'}-{outcome.label}"
    target = folder / name
    target.mkdir(parents=True, exist_ok=True)
    (target / "session.json").write_text(json.dumps(session))
    for k, past in enumerate(history):
        (target / f"history-{k}.json").write_text(json.dumps(past))
    (target / "found.json").write_text(json.dumps(found, indent=1))
    (target / "truth.txt").write_text(f"{outcome}\n")


def run(work: list[Task], processes: int) -> Iterator[Outcome]:
    """Outcomes in order."""
    if processes == 1:
        yield from map(examine, work)
        return
    with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool:
        outcomes: Iterable[Outcome] = pool.map(examine, work, chunksize=2)
        yield from outcomes
