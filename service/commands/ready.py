"""`imu-health ready`: whether a unit is warm and still enough for the long measurement."""

from pathlib import Path
from typing import Annotated, Any
from urllib.parse import urlencode

import typer
from pydantic import ValidationError
from rich.markup import escape

from estimator.errors import SessionError
from service.client import connect
from service.commands.console import AsJson, print_json, problem_line, screen
from service.commands.exits import FAILED, UNUSABLE, say
from service.errors import RefusedError
from service.ingest import read_file
from service.planning.ready import ReadyQuestion
from service.planning.rules import judged_by_defaults
from service.planning.words.readiness import headline, reasons


def ready(
    file: Annotated[Path, typer.Argument(metavar="SESSION", help="The first rows, or the first minutes of a raw log.")],
    *,
    duration: Annotated[
        float | None,
        typer.Option(help="Minutes that the measurement will take.", show_default="as the type's last session, or 96"),
    ] = None,
    bias: Annotated[
        float | None, typer.Option(help="Tolerance of the bias, µg (°/h).", show_default="50, 0.05")
    ] = None,
    scale: Annotated[float | None, typer.Option(help="Tolerance of the scale factor, ppm.", show_default="100")] = None,
    coefficient: Annotated[
        float | None,
        typer.Option(
            help="Temperature coefficient of the zeros at most, µg/K (°/h/K): then the thermometer is judged too.",
            show_default=False,
        ),
    ] = None,
    unit_type: Annotated[
        str | None,
        typer.Option("--type", help="Unit type by whose tolerances is judged; asks --server.", show_default=False),
    ] = None,
    server: Annotated[
        str | None,
        typer.Option(help="Service that knows the unit and its type.", envvar="IMU_HEALTH_SERVER", show_default=False),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Say whether a unit is warm and still enough to be measured, by the first minutes of a record: exit code 0 for
    ready, 1 for not yet.

    Leave the block in one position and record: imu-health ready first-minutes.json --duration 96. What is judged is the
    drift to come while the programme lasts, against a quarter of the tolerances. Nothing is stored.
    """
    try:
        asked = ReadyQuestion(minutes=duration, unit_type=unit_type, bias=bias, scale=scale, coefficient=coefficient)
    except ValidationError as fault:
        faults = "; ".join(f"{'.'.join(map(str, e['loc']))}: {e['msg']}" for e in fault.errors())
        raise typer.BadParameter(faults) from fault
    if unit_type is not None and server is None:
        raise typer.BadParameter("--type is known to a service: give its address with --server")
    document = _here(file, asked) if server is None else _there(file, asked, server)
    _show(document, as_json)
    if not document["ready"]:
        raise typer.Exit(FAILED)


def _here(file: Path, asked: ReadyQuestion) -> dict[str, Any]:
    """On this machine, by default tolerances."""
    try:
        answer = judged_by_defaults(read_file(file, part=True), asked)
    except SessionError as fault:
        say(problem_line(file, fault.problems))
        raise typer.Exit(UNUSABLE) from fault
    except OSError as fault:
        say(f"{file}: file: {fault.strerror or fault}; check the name and that it can be read")
        raise typer.Exit(UNUSABLE) from fault
    said = [headline(answer.found), *reasons(answer.found, answer.kind)]
    return {**answer.found.to_dict(), "unit_type": None, "said": said}


def _there(file: Path, asked: ReadyQuestion, server: str) -> dict[str, Any]:
    """By the service, which knows the unit."""
    query = urlencode(asked.model_dump(exclude_none=True))
    try:
        content = file.read_bytes()
    except OSError as fault:
        say(f"{file}: file: {fault.strerror or fault}; check the name and that it can be read")
        raise typer.Exit(UNUSABLE) from fault
    with connect(server) as client:
        try:
            return dict(client.answer("POST", f"/plan/ready?{query}", files={"file": (file.name, content)}).json())
        except RefusedError as fault:
            say(problem_line(file, fault.problems))
            raise typer.Exit(UNUSABLE) from fault


def _show(document: dict[str, Any], as_json: bool) -> None:
    if as_json:
        print_json(document)
        return
    colour = "green" if document["ready"] else "bold red"
    first, *others = document["said"]
    screen().print(
        f"[bold]{escape(document['unit'])}[/]  [{colour}]{escape(first)}[/]", *map(escape, others), sep="\n  "
    )
