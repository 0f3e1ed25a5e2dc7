"""`imu-health doctor`: what the service needs, looked at from this machine, and what to do where something lacks."""

import os
from collections.abc import Iterator
from dataclasses import asdict
from datetime import UTC, datetime
from typing import Annotated

import typer
from pydantic import ValidationError
from rich.markup import escape

from service.commands.console import print_json, screen
from service.commands.examine import Finding, State, contradictions, database, folders, program, variables
from service.commands.exits import FAILED
from service.commands.options import DatabaseUrl, DataFolder
from service.errors import ServiceError
from service.settings import Settings

COLOURS = {State.OK: "green", State.WARN: "yellow", State.FAIL: "red"}


def doctor(
    database_url: DatabaseUrl = None,
    data_folder: DataFolder = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, one finding a line.")] = False,
) -> None:
    """Look at everything the service needs on this machine, and say what to do; exit code 1 where something fails."""
    found = list(_findings(database_url=database_url, data_folder=data_folder))
    for one in found:
        if as_json:
            print_json(asdict(one))
        else:
            remedy = f"\n      {escape(one.remedy)}" if one.remedy else ""
            mark = f"[{COLOURS[one.state]}]{one.state:4}[/]"
            screen().print(f"{mark}  [bold]{escape(one.what)}[/]: {escape(one.text)}{remedy}", soft_wrap=True)
    if any(one.state is State.FAIL for one in found):
        raise typer.Exit(FAILED)


def _findings(**options: object) -> Iterator[Finding]:
    yield from program()
    yield from variables(os.environ)
    try:
        settings = Settings(**{name: value for name, value in options.items() if value is not None})  # type: ignore[arg-type]
    except ServiceError as fault:
        yield Finding("settings", State.FAIL, str(fault))
        return
    except ValidationError as fault:
        for error in fault.errors():
            name = "IMU_HEALTH_" + "_".join(map(str, error["loc"])).upper()
            yield Finding("settings", State.FAIL, f"{name}: {error['msg']}", "Correct it or unset it.")
        return
    yield from contradictions(settings)
    yield from folders(settings)
    yield from database(settings, datetime.now(UTC))
