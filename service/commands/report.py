"""`imu-health fleet` and `imu-health report`: the fleet's condition from a running service."""

from enum import StrEnum
from typing import Annotated, Any
from urllib.parse import quote

import typer
from rich.markup import escape
from rich.table import Table

from estimator.wording import counted
from service.client import connect
from service.commands.console import DEFAULT_SERVER, AsJson, Out, Server, deliver, print_json, screen
from service.commands.upload import coloured
from service.measures import number
from service.records.decision import Verdict
from service.words.conditions import WITH_RESERVATION


class Format(StrEnum):
    """What a report can be written as."""

    JSON = "json"
    CSV = "csv"
    XLSX = "xlsx"
    PDF = "pdf"


def fleet(server: Server = DEFAULT_SERVER, as_json: AsJson = False) -> None:
    """Show every unit with its condition, the worst first; --json prints how many units are in which."""
    with connect(server) as client:
        condition = client.get("/fleet").json()
        if as_json:
            print_json(condition)
        else:
            screen().print(_summary(condition), _table(client.get("/fleet/report").json()["units"]))


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
    with connect(server) as client:
        deliver(client.get("/fleet/report", format=format.value).content, out)


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
    table = Table(box=None, pad_edge=False, header_style="bold", padding=(0, 2, 0, 0))
    for heading in ("unit", "type", "condition", "margin", "last session", "sessions", "why"):
        table.add_column(heading, justify="right" if heading in ("margin", "sessions") else "left")
    for unit in units:
        table.add_row(
            escape(unit["serial"]) + (" [dim](simulated)[/]" if unit["simulated"] else ""),
            escape(unit["unit_type"]),
            coloured(unit["verdict"], unit["is_reference"], unit["said"]) if unit["verdict"] else "",
            number(unit["margin"], 2),
            (unit["last_at"] or "")[:10],
            str(unit["sessions"]),
            escape(unit["reason"]),
        )
    return table
