"""`imu-health units` and `due`: the register of units of a running service, and what is due when."""

from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from service.client import connect
from service.commands.api import At, By, Unit
from service.commands.calls import Answer, Call, ListColumns, Row
from service.commands.console import DEFAULT_SERVER, Out, Server, deliver, screen, usable
from service.commands.speech import output_language, translated

Location = Annotated[str | None, typer.Option(help="Where it is; empty if unknown.", show_default="as it is")]
Custodian = Annotated[str | None, typer.Option(help="Who has it; empty for nobody.", show_default="as it is")]
Owner = Annotated[str | None, typer.Option(help="To whom it belongs.", show_default="as it is")]
UnitType = Annotated[
    str | None, typer.Option("--type", help="Name of its type; needed of a new unit.", show_default="as it is")
]
Note = Annotated[str | None, typer.Option(help="What is worth knowing.", show_default="as it is")]
Remark = Annotated[str, typer.Option(help="Why, or what is worth knowing.")]
Why = Annotated[str, typer.Option("--why", help="Why.")]


def import_register(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="CSV with the columns of the register.")],
    by: By,
    server: Server = DEFAULT_SERVER,
) -> None:
    """Enter or change the units of a CSV file; where a row is wrong, nothing is stored."""
    with usable(file), connect(server, language=output_language()) as client:
        sent = {"files": {"file": (file.name, file.read_bytes())}, "data": {"by": by}}
        done = client.answer("POST", "/register", **sent).json()
    screen().print(translated("{new} new, {changed} changed, {unchanged} unchanged", **done))


def export_register(server: Server = DEFAULT_SERVER, out: Out = None) -> None:
    """Write the register as CSV, which can be changed and imported."""
    with connect(server, language=output_language()) as client:
        deliver(client.get("/register", format="csv").content, out)


def _show_entry(entry: Answer) -> None:
    known = {name: escape(entry[name]) for name in ("location", "custodian", "owner", "note") if entry[name]}
    facts = ", ".join(f"{translated(name)} {text}" for name, text in known.items())
    retired = f"  [bold red]{translated('retired')} {entry['retired_at'][:10]}[/]" if entry["retired_at"] else ""
    screen().print(f"[bold]{escape(entry['unit'])}[/]  {escape(entry['unit_type'])}{retired}  {facts}")
    for line in entry.get("history", ()):
        moved = f"{line['location'] or '–'}, {line['custodian'] or '–'}"
        remark = escape(translated(line["remark"]))
        screen().print(
            f"  {line['at'][:10]}  {translated(line['step'])}  {escape(moved)}  {escape(line['who'])}  {remark}"
        )


REGISTER = ListColumns(
    "units",
    "No unit is known yet.",
    {
        "unit": lambda unit: escape(unit["unit"]),
        "type": lambda unit: escape(unit["unit_type"]),
        "location": lambda unit: escape(unit["location"]),
        "custodian": lambda unit: escape(unit["custodian"]),
        "owner": lambda unit: escape(unit["owner"]),
        "retired": lambda unit: (unit["retired_at"] or "")[:10],
    },
)
DUE = ListColumns(
    "units",
    "Nothing is due.",
    {
        "due": lambda line: line["due"][:10] if line["due"] else translated("no date"),
        "days": lambda line: "" if line["days"] is None else str(line["days"]),
        "unit": lambda line: escape(line["unit"]),
        "location": lambda line: escape(line["location"]),
        "custodian": lambda line: escape(line["custodian"]),
        "condition": lambda line: escape(line["condition"]),
        "use": lambda line: escape(line["said"]),
    },
)
WANTED = {
    "when": (
        Annotated[str | None, typer.Option(help="overdue, unknown or a month: 2026-12", show_default="all")],
        None,
    ),
    "location": (Annotated[str | None, typer.Option(help="Only at this location.", show_default="all")], None),
    "custodian": (Annotated[str | None, typer.Option(help="Only of this custodian.", show_default="all")], None),
}
ENTRY = {
    "unit": Unit,
    "by": By,
    "unit_type": (UnitType, None),
    "owner": (Owner, None),
    "location": (Location, None),
    "custodian": (Custodian, None),
    "note": (Note, None),
}
MOVE = {"unit": Unit, "by": By, "location": (Location, None), "custodian": (Custodian, None), "at": (At, None),
        "remark": (Remark, "")}  # fmt: skip
RETIREMENT = {"unit": Unit, "by": By, "why": Why, "at": (At, None)}
COMMANDS: dict[str, Row] = {
    "due": Call("GET /fleet/due", WANTED, DUE),
    "units": Call("GET /register", {}, REGISTER),
    "units show": Call(
        "GET /units/{unit}/register", {"unit": Unit}, _show_entry,
        "Show where a unit is and who has it, and its history."
    ),
    "units enter": Call(
        "PUT /units/{unit}/register", ENTRY, _show_entry, "Enter a unit, or change what the register says of it."
    ),
    "units move": Call("POST /units/{unit}/moves", MOVE, _show_entry, "Record where a unit is and who has it."),
    "units retire": Call(
        "POST /units/{unit}/retire", RETIREMENT, _show_entry,
        "Retire a unit: fleet, due dates and alarms leave it out; its records stay.",
    ),
    "units return": Call(
        "POST /units/{unit}/return", RETIREMENT, _show_entry, "Put a retired unit back into use."
    ),
    "units import": import_register,
    "units export": export_register,
}  # fmt: skip
