"""`imu-health fleet` and `imu-health report`: the fleet's condition from a running service."""

from datetime import datetime
from enum import StrEnum
from typing import Annotated, Any
from urllib.parse import quote

import typer
from rich.console import Group
from rich.markup import escape
from rich.table import Table

from estimator.wording import counted
from service.client import connect
from service.commands.console import DEFAULT_SERVER, Out, Server, deliver, progress
from service.commands.listing import AsLines, FormOf, Listing, table_of
from service.commands.speech import said
from service.commands.upload import coloured
from service.kit.measures import number
from service.sessions.decision import Verdict
from service.sessions.words.conditions import WITH_RESERVATION


class Format(StrEnum):
    """What a report can be written as."""

    JSON = "json"
    CSV = "csv"
    XLSX = "xlsx"
    PDF = "pdf"


Stand = Annotated[str | None, typer.Option(help="Only those last measured on this stand.", show_default="all")]
UnitType = Annotated[str | None, typer.Option("--unit-type", help="Only those of this type.", show_default="all")]
DueBefore = Annotated[
    datetime | None, typer.Option(help="Only those whose next calibration is due before, UTC.", show_default="all")
]
Flagged = Annotated[bool, typer.Option("--flagged", help="Only those with an open flag.")]


def fleet(
    server: Server = DEFAULT_SERVER,
    form: FormOf = None,
    as_json: AsLines = False,
    *,
    stand: Stand = None,
    unit_type: UnitType = None,
    due_before: DueBefore = None,
    flagged: Flagged = False,
) -> None:
    """Show every unit with its condition, the worst first; some of them by stand, type, due date or flag."""
    due = None if due_before is None else f"{due_before.isoformat()}Z"
    wanted = {"stand": stand, "unit_type": unit_type, "due_before": due, "flagged": flagged or None}
    with connect(server) as client:
        condition = client.get("/fleet").json()
        found = [unit.document for unit in client.units(**wanted)]
    is_whole = len(found) == condition["units"]
    heading = _summary(condition) if is_whole else f"{len(found)} of {counted(condition['units'], 'unit')}\n"
    Listing(form, as_json).show(found, lambda: Group(heading, _table(found)))


class LabelFormat(StrEnum):
    """What a label can be written as."""

    PDF = "pdf"
    SVG = "svg"


report = typer.Typer(add_completion=False, rich_markup_mode="markdown", invoke_without_command=True)


@report.callback()
def write_report(
    context: typer.Context,
    server: Server = DEFAULT_SERVER,
    format: Annotated[Format, typer.Option("--format", help="json, csv, xlsx or pdf.")] = Format.CSV,
    out: Out = None,
) -> None:
    """Write the fleet's condition as a file for other programs."""
    if context.invoked_subcommand is not None:
        return
    with connect(server) as client, progress(1, "making the report", is_long=format in (Format.XLSX, Format.PDF)):
        content = client.get("/fleet/report", format=format.value).content
    deliver(content, out)


@report.command("label")
def write_label(
    unit: Annotated[str, typer.Argument(metavar="UNIT", help="Serial number.")],
    server: Server = DEFAULT_SERVER,
    format: Annotated[LabelFormat, typer.Option("--format", help="pdf or svg.")] = LabelFormat.PDF,
    due: Annotated[bool, typer.Option(help="Say when the calibration is due.")] = True,
    out: Out = None,
) -> None:
    """Write a unit's label: serial number, due date, and a QR code that opens its page."""
    path = f"/units/{quote(unit, safe='')}/label.{format.value}"
    with connect(server) as client:
        deliver(client.get(path, due=str(due).lower()).content, out)


def _summary(condition: dict[str, Any]) -> str:
    """``12 units, 12 of them simulated: 1 Unfit, …``"""
    counts = {Verdict(name): count for name, count in condition["verdicts"].items() if count}
    found = (_counted(verdict, counts[verdict], condition) for verdict in reversed(Verdict) if verdict in counts)
    simulated = f", {condition['simulated']} of them simulated" if condition["simulated"] else ""
    return f"{counted(condition['units'], 'unit')}{simulated}: {', '.join(found)}\n"


def _counted(verdict: Verdict, count: int, condition: dict[str, Any]) -> str:
    """``5 Fit (2 with reservation)``"""
    reserved = condition["reserved"][verdict]
    return f"{count} {coloured(verdict)}{f' ({reserved} {WITH_RESERVATION})' if reserved else ''}"


def _table(units: list[dict[str, Any]]) -> Table:
    headings = ("unit", "type", "condition", "margin", "last session", "sessions", "why")
    table = table_of(*headings, right=("margin", "sessions"))
    for unit in units:
        table.add_row(
            escape(unit["serial"]) + (" [dim](simulated)[/]" if unit["simulated"] else ""),
            escape(unit["unit_type"]),
            coloured(unit["verdict"], unit["is_reference"], unit["said"]) if unit["verdict"] else "",
            number(unit["margin"], 2),
            (unit["last_at"] or "")[:10],
            str(unit["sessions"]),
            escape(said(unit["reason"])),
        )
    return table
