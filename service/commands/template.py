"""`imu-health template`: a session file to fill in, from a running service."""

import os
from pathlib import Path
from typing import Annotated

import typer

from service.client import connect
from service.commands.console import DEFAULT_SERVER, Server
from service.commands.exits import say
from service.languages.language import Language, of_environment

Unit = Annotated[str, typer.Option(help="Like the last session of this serial number.")]
UnitType = Annotated[str, typer.Option("--unit-type", help="For this stored type of units.")]
Kind = Annotated[str, typer.Option(help="Without a unit and a type: accelerometer or gyroscope.")]
Sensors = Annotated[int, typer.Option(help="Without a unit and a type: how many.")]
Lang = Annotated[
    Language | None, typer.Option(help="Of its sheets, headings and hints.", show_default="the system's: LANG")
]
Out = Annotated[Path, typer.Option(help="File to write.")]


def write_template(
    server: Server = DEFAULT_SERVER,
    *,
    unit: Unit = "",
    unit_type: UnitType = "",
    kind: Kind = "accelerometer",
    sensors: Sensors = 6,
    lang: Lang = None,
    out: Out = Path("session.xlsx"),
) -> None:
    """Write a workbook to fill in: sensors, stand and schedule are there; `imu-health upload` takes it as it is."""
    with connect(server) as client:
        asked = {"unit": unit, "unit_type": unit_type, "kind": kind, "sensors": str(sensors)}
        language = lang or of_environment(os.environ)
        out.write_bytes(client.get("/session-template", lang=language.value, **asked).content)
    say(f"{out} is ready to fill in: its yellow cells; then imu-health upload {out}")
