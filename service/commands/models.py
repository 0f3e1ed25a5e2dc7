"""`imu-health models`: what engineers accepted into the models of units, unit types and stands, and what it moved."""

from typing import Annotated, Any
from urllib.parse import quote

import typer
from rich.markup import escape
from rich.table import Table

from estimator.wording import counted
from service.client import Client, connect
from service.commands.console import DEFAULT_SERVER, AsJson, Server, print_json, screen
from service.commands.listing import AsLines, FormOf, Listing, table_of
from service.errors import RefusedError, ServiceError
from service.groups.records import Level

PATHS = {Level.UNIT: "units", Level.TYPE: "unit-types", Level.STAND: "stands"}
models = typer.Typer(
    name="models",
    add_completion=False,
    invoke_without_command=True,
    help="Show accepted causes and what they moved; accept what sessions show together, or withdraw it.",
)
By = Annotated[str, typer.Option("--by", help="Your name.")]
Why = Annotated[str, typer.Option("--why", help="Why; what was found or done.")]
Id = Annotated[int, typer.Argument(metavar="REVISION", help="Number of the revision.")]


@models.callback()
def list_models(
    context: typer.Context, server: Server = DEFAULT_SERVER, form: FormOf = None, as_json: AsLines = False
) -> None:
    """Show accepted causes, newest first."""
    if context.invoked_subcommand is not None:
        return
    with connect(server) as client:
        found = list(client.every("/models", "models", limit=1000))
    Listing(form, as_json).show(found, lambda: _table(found) if found else "No cause is accepted.")


@models.command("accept")
def accept(
    level: Annotated[Level, typer.Argument(help="Whose sessions: of a unit, of a type, or on a stand.")],
    name: Annotated[str, typer.Argument(help="Serial number of the unit, or name of the type or stand.")],
    cause: Annotated[str, typer.Argument(help="Identifier of a cause that these sessions show together.")],
    by: By,
    why: Why = "",
    sensor: Annotated[list[str] | None, typer.Option(help="Sensor of the finding, where several have it.")] = None,
    server: Server = DEFAULT_SERVER,
    as_json: AsJson = False,
) -> None:
    """Accept what sessions show together; every session that it concerns is computed again."""
    body = {"cause": cause, "sensors": sensor or [], "by": by, "note": why}
    with connect(server) as client:
        try:
            made = client.post(f"/{PATHS[level]}/{quote(name)}/diagnosis/accept", body)
        except RefusedError as refused:
            why_not = "; ".join(f"{problem.field} {problem.message}" for problem in refused.problems)
            raise ServiceError(f"{refused.detail} {why_not}") from refused
        _show(client, made["id"], as_json)


@models.command("withdraw")
def withdraw(id: Id, by: By, why: Why, server: Server = DEFAULT_SERVER, as_json: AsJson = False) -> None:
    """Take an accepted cause out of the model again."""
    with connect(server) as client:
        made = client.post(f"/models/{id}/withdraw", {"by": by, "why": why})
        _show(client, made["id"], as_json)


@models.command("show")
def show(id: Id, server: Server = DEFAULT_SERVER, as_json: AsJson = False) -> None:
    """Show a revision: how far its sessions are computed again, and what moved."""
    with connect(server) as client:
        _show(client, id, as_json)


def _show(client: Client, id: int, as_json: bool) -> None:
    found = client.get(f"/models/{id}").json()
    if as_json:
        print_json(found)
        return
    screen().print(_line(found), highlight=False)
    for one in found["recomputations"]:
        screen().print(f"  [bold]{escape(one['unit'])}[/]  {_outcome(one)}", highlight=False)


def _line(revision: dict[str, Any]) -> str:
    what = "withdraws revision " + str(revision["withdraws"]) if revision["withdraws"] else "accepted"
    on = f" ({', '.join(revision['sensors'])})" if revision["sensors"] else ""
    who = f"{revision['scope']} {revision['subject']}"
    by = f"{what} by {revision['accepted_by']}, {revision['accepted_at'][:10]}"
    return escape(f"Revision {revision['id']}  {revision['cause']}{on}  of {who}, {by}")


def _outcome(one: dict[str, Any]) -> str:
    told = one["outcome"]
    if told is None:
        return str(one["state"])
    moved = [f"{m['session']} {m['before']} → {m['after']}" for m in told["verdicts"]]
    return f"{told['recomputed']} of {counted(told['sessions'], 'session')}; {'; '.join(moved) or 'no verdict moved'}"


def _table(found: list[dict[str, Any]]) -> Table:
    table = table_of("revision", "model of", "cause", "accepted", right=("revision",))
    for one in found:
        sensors = f" ({', '.join(one['sensors'])})" if one["sensors"] else ""
        state = f"withdraws {one['withdraws']}" if one["withdraws"] else one["accepted_at"][:10]
        table.add_row(
            str(one["id"]), escape(f"{one['scope']} {one['subject']}"), escape(one["cause"] + sensors), escape(state)
        )
    return table
