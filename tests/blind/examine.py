"""One case given to the diagnosis and marked."""

import json
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from estimator import Diagnosis, diagnose, read_session
from estimator.causes.catalogue import CATALOGUE
from tests.blind.case import Case
from tests.blind.cases import LEFT_OUT
from tests.blind.score import Outcome, score


def examine(case: Case, dump: str | None = None, diagnosing: Callable[..., Diagnosis] = diagnose) -> Outcome:
    """The marks of a case; with a folder, its files are left there when it went wrong."""
    start = time.perf_counter()
    found = diagnosed(case, diagnosing)
    outcome = score(case, found, time.perf_counter() - start)
    if dump and not outcome.good:
        _dump(Path(dump), outcome, case, found)
    return outcome


def diagnosed(case: Case, diagnosing: Callable[..., Diagnosis]) -> dict[str, Any]:
    """The diagnosis' answer, from the files alone; a failure of the numerics counts as a wrong name and goes on."""
    try:
        session = read_session(case.session)
        left_out = {t.effect.cause for t in case.truths} if case.kind == LEFT_OUT else set()
        known = [cause for cause in CATALOGUE if cause.identifier not in left_out]
        return diagnosing(session, history=[read_session(h) for h in case.history], catalogue=known).to_dict()
    except (ArithmeticError, ValueError) as error:
        wrong = {"cause": f"failure: {error}", "sensors": [], "alternatives": []}
        return {"findings": [wrong], "unexplained": False}


def _dump(folder: Path, outcome: Outcome, case: Case, found: dict[str, Any]) -> None:
    """The session, its history, what was found and the truth, as files."""
    target = folder / f"{'+'.join(outcome.causes) or 'none'}-{outcome.label}"
    target.mkdir(parents=True, exist_ok=True)
    (target / "session.json").write_text(json.dumps(case.session))
    for k, past in enumerate(case.history):
        (target / f"history-{k}.json").write_text(json.dumps(past))
    (target / "found.json").write_text(json.dumps(found, indent=1))
    (target / "truth.txt").write_text(f"{outcome}\n{case.truths}\n")
