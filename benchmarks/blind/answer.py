"""Our own answers: the diagnosis of every session of a folder, from its files alone."""

from collections.abc import Iterator
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from benchmarks.blind.folder import SESSION, numbers
from estimator import diagnose, read_session

SAID = ("cause", "sensors", "amplitude", "sigma", "alternatives")
"""What an answer holds of a finding."""


def answered(folder: Path, processes: int) -> Iterator[tuple[str, dict[str, Any]]]:
    """Every session's answer, by its number."""
    wanted, one = numbers(folder), partial(answer_of, folder)
    if processes == 1:
        yield from zip(wanted, map(one, wanted), strict=True)
        return
    with get_context("spawn").Pool(processes) as pool:
        yield from zip(wanted, pool.imap(one, wanted), strict=True)


def answer_of(folder: Path, number: str) -> dict[str, Any]:
    """The answer for one session; a failure of the numerics is an answer that names nothing."""
    own = folder / number
    history = [read_session(file) for file in sorted(own.glob("history-*.json"))]
    try:
        found = diagnose(read_session(own / SESSION), history=history).to_dict()
    except (ArithmeticError, ValueError):
        return {"findings": [], "unexplained": False}
    findings = [{name: finding[name] for name in SAID} for finding in found["findings"]]
    return {"findings": findings, "unexplained": found["unexplained"]}
