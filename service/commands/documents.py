"""Commands that write a file made by a running service: `certificate`, `correction`, `export`, `report`, `template`;
`sign` signs a certificate, and `seal` makes a key for trying electronic seals."""

import json
import os
from datetime import UTC, datetime
from enum import StrEnum
from pathlib import Path
from typing import Annotated
from urllib.parse import quote

import typer
from rich.markup import escape

from service.client import connect
from service.commands.calls import in_address
from service.commands.console import DEFAULT_SERVER, Out, Server, deliver, progress, screen
from service.commands.speech import output_language, say
from service.errors import ConflictError
from service.languages.language import Language, of_environment
from service.papers.changes import NOT_ISSUED
from service.papers.records import Meaning
from service.papers.sealing import seal_room
from service.papers.words import STATES
from service.settings import Settings


class ExportSystem(StrEnum):
    """Target system of the parameters."""

    PX4 = "px4"
    ARDUPILOT = "ardupilot"
    KALIBR = "kalibr"
    ROS2 = "ros2"


class CertificateForm(StrEnum):
    """Form of a certificate."""

    PDF = "pdf"
    DCC = "dcc"


class FleetReportForm(StrEnum):
    """Form of a report."""

    JSON = "json"
    CSV = "csv"
    XLSX = "xlsx"
    PDF = "pdf"


class LabelForm(StrEnum):
    """Form of a label."""

    PDF = "pdf"
    SVG = "svg"


Session = Annotated[str, typer.Argument(metavar="SESSION", help="The session's id, as its page's address ends.")]


def certificate(
    session: Session,
    server: Server = DEFAULT_SERVER,
    format: Annotated[
        CertificateForm, typer.Option("--format", help="pdf, to sign, or dcc: XML for programs.")
    ] = CertificateForm.PDF,
    by: Annotated[str, typer.Option("--by", help="Your name, kept with the certificate's number.")] = "",
    number: Annotated[
        str, typer.Option(help="Of an approved one, as it was approved.", show_default="the latest")
    ] = "",
    out: Out = None,
) -> None:
    """Write the certificate of a session."""
    path = "/sessions/{session}/certificates/{number}" if number else "/sessions/{session}/certificate"
    query = {"format": format.value} | ({} if number else {"by": by})
    with connect(server, language=output_language()) as client:
        deliver(client.get(in_address(path, {"session": session, "number": number}), **query).content, out)


def correction(session: Session, server: Server = DEFAULT_SERVER, out: Out = None) -> None:
    """Write the correction that firmware applies to readings, as JSON."""
    with connect(server, language=output_language()) as client:
        document = client.get(in_address("/sessions/{session}/correction", {"session": session})).json()
    deliver((json.dumps(document, indent=1, ensure_ascii=False) + "\n").encode(), out)


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
        path = in_address("/sessions/{session}/export", {"session": session})
        deliver(client.get(path, system=system.value, force=str(force).lower()).content, out)


report = typer.Typer(add_completion=False, rich_markup_mode="markdown", invoke_without_command=True)


@report.callback()
def write_report(
    context: typer.Context,
    server: Server = DEFAULT_SERVER,
    format: Annotated[FleetReportForm, typer.Option("--format", help="json, csv, xlsx or pdf.")] = FleetReportForm.CSV,
    out: Out = None,
) -> None:
    """Write the fleet's condition as a file for other programs."""
    if context.invoked_subcommand is not None:
        return
    is_long = format in (FleetReportForm.XLSX, FleetReportForm.PDF)
    with connect(server, language=output_language()) as client, progress(1, "making the report", is_long=is_long):
        content = client.get("/fleet/report", format=format.value).content
    deliver(content, out)


@report.command("label")
def write_label(
    unit: Annotated[str, typer.Argument(metavar="UNIT", help="Serial number.")],
    server: Server = DEFAULT_SERVER,
    format: Annotated[LabelForm, typer.Option("--format", help="pdf or svg.")] = LabelForm.PDF,
    due: Annotated[bool, typer.Option(help="Say when the calibration is due.")] = True,
    out: Out = None,
) -> None:
    """Write a unit's label: serial number, due date, and a QR code that opens its page."""
    path = in_address(f"/units/{{unit}}/label.{format.value}", {"unit": unit})
    with connect(server, language=output_language()) as client:
        deliver(client.get(path, due=str(due).lower()).content, out)


@report.command("status")
def write_status(
    unit: Annotated[str, typer.Argument(metavar="UNIT", help="Serial number.")],
    server: Server = DEFAULT_SERVER,
    out: Out = None,
) -> None:
    """Write one page to hand over with a unit: may it be used, due date, reservations, lines to sign; PDF."""
    with connect(server, language=output_language()) as client:
        deliver(client.get(in_address("/units/{unit}/status.pdf", {"unit": unit})).content, out)


def write_template(
    server: Server = DEFAULT_SERVER,
    *,
    unit: Annotated[str, typer.Option(help="Like the last session of this serial number.")] = "",
    unit_type: Annotated[str, typer.Option("--unit-type", help="For this stored type of units.")] = "",
    kind: Annotated[str, typer.Option(help="Without a unit and a type: accelerometer or gyroscope.")] = "accelerometer",
    sensors: Annotated[int, typer.Option(help="Without a unit and a type: how many.")] = 6,
    lang: Annotated[
        Language | None, typer.Option(help="Of its sheets, headings and hints.", show_default="the system's: LANG")
    ] = None,
    out: Annotated[Path, typer.Option(help="File to write.")] = Path("session.xlsx"),
) -> None:
    """Write a workbook to fill in: sensors, stand and schedule are there; `imu-health upload` takes it as it is."""
    query = {"unit": unit, "unit_type": unit_type, "kind": kind, "sensors": sensors}
    language = lang or of_environment(os.environ)
    with connect(server, language=output_language()) as client:
        out.write_bytes(client.get("/session-template", lang=language.value, **query).content)
    say(f"{out} is ready to fill in: its yellow cells; then imu-health upload {out}")


OWNER_ONLY = 0o600
"""Permissions of a file with a key."""
seal = typer.Typer(name="seal", add_completion=False, no_args_is_help=True, help="The laboratory's electronic seal.")


def sign(
    session: Session,
    meaning: Annotated[Meaning, typer.Option(help="What your signature says.", show_default=False)],
    number: Annotated[str, typer.Option(help="Of the certificate that you read.", show_default="the latest")] = "",
    server: Server = DEFAULT_SERVER,
) -> None:
    """Sign the certificate of a session: reviewed, then approved by somebody else. Asks for your password."""
    path = f"/sessions/{quote(session, safe='')}/certificate"
    with connect(server, language=output_language()) as client:
        issued = client.get(f"{path}s").json()["certificates"]
        if not issued:
            raise ConflictError(NOT_ISSUED)
        certificate = number or issued[-1]["number"]
        say(f"Certificate {certificate}: {STATES[meaning]}")
        password = typer.prompt("Your password", hide_input=True, err=True)
        signature = client.post(f"{path}/signatures", {"number": certificate, "meaning": meaning, "password": password})
    screen().print(f"[bold]{escape(signature['certificate'])}[/]  {meaning} by {escape(signature['name'])}")


@seal.callback()
def _group() -> None:
    """The laboratory's electronic seal."""


@seal.command("trial")
def make_trial(
    out: Annotated[Path, typer.Option(help="File to write; one that is there stays as it is.", show_default=False)],
) -> None:
    """Make a key that nobody trusts, to try seals with: it says so in its name, and holds for ninety days."""
    key: bytes = seal_room("trial").make_trial_key(Settings().laboratory_name, datetime.now(UTC))
    file = os.open(out, os.O_WRONLY | os.O_CREAT | os.O_EXCL, OWNER_ONLY)
    with os.fdopen(file, "wb") as opened:
        opened.write(key)
    say(f"{out}: a key for trial. Start the service with IMU_HEALTH_SEAL_KEY_FILE={out}.")
