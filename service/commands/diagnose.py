"""`imu-health diagnose`: what the simulation gets wrong about session files, without a server."""

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

from estimator import CalibrationSession, diagnose
from estimator.errors import SessionError
from estimator.session import CALIBRATIONS
from service.commands.console import UNUSABLE, AsJson, Files, for_each, print_json, problem_line, say, screen
from service.commands.diagnosis_tables import diagnosis_view
from service.ingest import read_file
from service.records.diagnosis import DiagnosisState
from service.words.diagnosis import document_of, inapplicable, state_of

Result = tuple[CalibrationSession, dict[str, Any], DiagnosisState]
History = Annotated[
    list[Path] | None,
    typer.Option(help="An earlier session of the unit; repeat it for more, oldest first.", show_default=False),
]


def diagnose_files(files: Files, as_json: AsJson = False, history: History = None) -> None:
    """Say what the simulation gets wrong: the cause with its size, what else it could be, and what cannot be seen."""
    earlier = [_earlier(file) for file in history or ()]
    show: Callable[[Result], None] = _print_json if as_json else _print_view
    for_each(files, lambda file: _diagnosed(file, earlier), show, "diagnosing")


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
    if session.programme not in CALIBRATIONS:
        return session, inapplicable(session.unit), DiagnosisState.NOT_APPLICABLE
    found = diagnose(session, history=earlier)
    return session, document_of(found), state_of(found)


def _print_json(result: Result) -> None:
    print_json(result[1])


def _print_view(result: Result) -> None:
    screen().print(diagnosis_view(*result))
