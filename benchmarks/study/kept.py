"""Outcomes kept in a file as they come: a study of an hour that is stopped goes on where it was."""

import json
import sys
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from time import monotonic
from typing import Any

from benchmarks.study.examine import Task, run
from tests.blind.score import Outcome, Pull

BUILD = Path(__file__).parents[2] / "build"


def resumed(work: list[Task], processes: int, path: Path) -> Iterator[Outcome]:
    """The outcomes of all tasks in order: those that the file holds first, then the others, each written as it comes.
    How long the rest will take goes to standard error."""
    before = _read(path)[: len(work)]
    yield from before
    path.parent.mkdir(parents=True, exist_ok=True)
    begun = monotonic()
    with path.open("w") as file:
        file.writelines(_line(outcome) for outcome in before)
        for k, outcome in enumerate(run(work[len(before) :], processes), 1):
            file.write(_line(outcome))
            file.flush()
            left = (monotonic() - begun) / k * (len(work) - len(before) - k)
            print(f"\r{len(before) + k}/{len(work)}, {left / 60:.0f} min left ", end="", file=sys.stderr)
            yield outcome
    print(file=sys.stderr)


def _line(outcome: Outcome) -> str:
    return json.dumps(asdict(outcome)) + "\n"


def _read(path: Path) -> list[Outcome]:
    """Whole lines only: the last one may have been cut off."""
    if not path.exists():
        return []
    with path.open() as file:
        return [_outcome(line) for line in file if line.endswith("\n")]


def _outcome(line: str) -> Outcome:
    values = {name: _tuples(value) for name, value in json.loads(line).items()}
    return Outcome(**values | {"pulls": tuple(Pull(**p) for p in values["pulls"])})


def _tuples(value: Any) -> Any:
    return tuple(map(_tuples, value)) if isinstance(value, list) else value
