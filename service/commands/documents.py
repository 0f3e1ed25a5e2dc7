"""Commands that write a file made by a running service: `export`, `report`, `template`."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated
from urllib.parse import quote

import typer

from service.client import connect
from service.commands.console import DEFAULT_SERVER, Out, Server, deliver, progress
from service.commands.speech import output_language, say


class ExportSystem(StrEnum):
    """Target system of the parameters."""

    PX4 = "px4"
    ARDUPILOT = "ardupilot"
    KALIBR = "kalibr"
    ROS2 = "ros2"


class FleetReportForm(StrEnum):
    """Form of a report."""

    JSON = "json"
    CSV = "csv"
    XLSX = "xlsx"
    PDF = "pdf"


Session = Annotated[str, typer.Argument(metavar="SESSION", help="The session's id, as its page's address ends.")]


def export(
    session: Session,
    system: Annotated[ExportSystem, typer.Option("--system", help="px4, ardupilot, kalibr or ros2.")],
    server: Server = DEFAULT_SERVER,
    out: Out = None,
    *,
    force: Annotated[bool, typer.Option("--force", help="Also where the unit must not be used.")] = False,
) -> None:
    """Write the correction as parameters of PX4, ArduPilot, Kalibr or ROS 2."""
    with connect(server, language=output_language()) as client:
        path = f"/sessions/{quote(session, safe='')}/export"
        deliver(client.get(path, system=system.value, force=str(force).lower()).content, out)


def report(
    server: Server = DEFAULT_SERVER,
    format: Annotated[FleetReportForm, typer.Option("--format", help="json, csv, xlsx or pdf.")] = FleetReportForm.CSV,
    out: Out = None,
) -> None:
    """Write the fleet's condition as a file for other programs."""
    is_long = format in (FleetReportForm.XLSX, FleetReportForm.PDF)
    with connect(server, language=output_language()) as client, progress(1, "making the report", is_long=is_long):
        content = client.get("/fleet/report", format=format.value).content
    deliver(content, out)


def write_template(
    server: Server = DEFAULT_SERVER,
    *,
    unit: Annotated[str, typer.Option(help="Like the last session of this serial number.")] = "",
    unit_type: Annotated[str, typer.Option("--unit-type", help="For this stored type of units.")] = "",
    kind: Annotated[str, typer.Option(help="Without a unit and a type: accelerometer or gyroscope.")] = "accelerometer",
    sensors: Annotated[int, typer.Option(help="Without a unit and a type: how many.")] = 6,
    out: Annotated[Path, typer.Option(help="File to write.")] = Path("session.xlsx"),
) -> None:
    """Write a workbook to fill in: sensors, stand and schedule are there; `imu-health upload` takes it as it is."""
    query = {"unit": unit, "unit_type": unit_type, "kind": kind, "sensors": sensors}
    with connect(server, language=output_language()) as client:
        out.write_bytes(client.get("/session-template", lang=output_language(), **query).content)
    say(f"{out} is ready to fill in: its yellow cells; then imu-health upload {out}")
