"""`imu-health diagnose`: what the simulation gets wrong about session files, without a server."""

from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer

from estimator import CalibrationSession, diagnose
from estimator.diagnosis import Diagnosis
from estimator.errors import SessionError
from estimator.session import DIAGNOSED
from service.commands.console import AsJson, Files, for_each, print_json, problem_line, screen
from service.commands.diagnosis_tables import diagnosis_view
from service.commands.exits import UNUSABLE, say
from service.diagnosis.document import inapplicable_to_dict
from service.ingest import read_file

Result = tuple[CalibrationSession, Diagnosis | None]
"""None of a programme in which no causes are looked for."""
History = Annotated[
    list[Path] | None,
    typer.Option(help="An earlier session of the unit; repeat it for more, oldest first.", show_default=False),
]


def diagnose_files(files: Files, as_json: AsJson = False, history: History = None) -> None:
    """Say what the simulation gets wrong: the cause with its size, what else it could be, and what cannot be seen."""
    earlier = [_earlier(file) for file in history or ()]
    show: Callable[[Result], None] = _print_json if as_json else _print_view
    for_each(files, lambda file: _diagnosed(file, earlier), show, "diagnosing", quiet=as_json)


def _earlier(file: Path) -> CalibrationSession:
    """A session of the history; without it the answer would be another one, so it must be readable."""
    try:
        return read_file(file)
    except SessionError as fault:
        say(problem_line(file, fault.problems))
    except OSError as fault:
        say(f"{file}: file: {fault.strerror or fault}; check the name and that it can be read")
    raise typer.Exit(UNUSABLE)


def _diagnosed(file: Path, earlier: list[CalibrationSession]) -> Result:
    session = read_file(file)
    return session, diagnose(session, history=earlier) if session.programme in DIAGNOSED else None


def _print_json(result: Result) -> None:
    session, found = result
    print_json(inapplicable_to_dict(session.unit) if found is None else found.to_dict())


def _print_view(result: Result) -> None:
    screen().print(diagnosis_view(*result))
