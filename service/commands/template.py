"""`imu-health template`: a session file to fill in, from a running service."""

from pathlib import Path
from typing import Annotated

import typer

from service.client import connect
from service.commands.console import DEFAULT_SERVER, Server
from service.commands.exits import say

Unit = Annotated[str, typer.Option(help="Like the last session of this serial number.")]
UnitType = Annotated[str, typer.Option("--unit-type", help="For this stored type of units.")]
Kind = Annotated[str, typer.Option(help="Without a unit and a type: accelerometer or gyroscope.")]
Sensors = Annotated[int, typer.Option(help="Without a unit and a type: how many.")]
Out = Annotated[Path, typer.Option(help="File to write.")]


def write_template(
    server: Server = DEFAULT_SERVER,
    *,
    unit: Unit = "",
    unit_type: UnitType = "",
    kind: Kind = "accelerometer",
    sensors: Sensors = 6,
    out: Out = Path("session.xlsx"),
) -> None:
    """Write a workbook to fill in: sensors, stand and schedule are there; `imu-health upload` takes it as it is."""
    with connect(server) as client:
        asked = {"unit": unit, "unit_type": unit_type, "kind": kind, "sensors": str(sensors)}
        out.write_bytes(client.get("/session-template", **asked).content)
    say(f"{out} is ready to fill in: yellow cells on the sheets session and readings; then imu-health upload {out}")
