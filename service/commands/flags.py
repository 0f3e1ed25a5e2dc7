"""`imu-health flags`: what somebody must look after, and what people do about it."""

from itertools import takewhile
from typing import Annotated, Any

import typer
from rich.markup import escape
from rich.table import Table

from service.client import connect
from service.commands.console import DEFAULT_SERVER, Server, screen
from service.commands.listing import AsLines, FormOf, Listing, table_of
from service.commands.speech import said
from service.flags.records import FlagState

COLOURS = {FlagState.RAISED: "red", FlagState.ACKNOWLEDGED: "yellow", FlagState.RESOLVED: "green"}
"""Red asks for somebody."""
flags = typer.Typer(
    name="flags",
    add_completion=False,
    invoke_without_command=True,
    help="Show what somebody must look after; give it to somebody, acknowledge or resolve it.",
)
By = Annotated[str, typer.Option("--by", help="Your name.")]
Why = Annotated[str, typer.Option("--why", help="Why; what was found or done.")]
Id = Annotated[int, typer.Argument(metavar="FLAG", help="Number of the flag.")]


@flags.callback()
def list_flags(
    context: typer.Context,
    unit: Annotated[str | None, typer.Option(help="Only of this serial number.")] = None,
    state: Annotated[FlagState | None, typer.Option(help="Only in this state.", show_default="open ones")] = None,
    assigned: Annotated[
        str | None, typer.Option(help="Only of this login or name; `me`: of the token's account; `nobody`.")
    ] = None,
    server: Server = DEFAULT_SERVER,
    *,
    form: FormOf = None,
    as_json: AsLines = False,
) -> None:
    """Show flags; without a state those that are open."""
    if context.invoked_subcommand is not None:
        return
    wanted = {"unit": unit, "state": None if state is None else state.value, "assigned": assigned}
    with connect(server) as client:
        found = client.every("/flags", "flags", limit=1000, **{k: v for k, v in wanted.items() if v})
        shown = list(found if state is not None else takewhile(_is_open, found))
    none = "No flag is open." if state is None else "There is none."
    Listing(form, as_json).show(shown, lambda: _table(shown) if shown else none)


@flags.command("acknowledge")
def acknowledge(id: Id, by: By, why: Why, server: Server = DEFAULT_SERVER) -> None:
    """Say that somebody looks after the flag, and why it can stay for now."""
    _handle(id, "acknowledge", by, why, server)


@flags.command("resolve")
def resolve(id: Id, by: By, why: Why, server: Server = DEFAULT_SERVER) -> None:
    """Say that the matter is settled, and how."""
    _handle(id, "resolve", by, why, server)


@flags.command("assign")
def assign(
    ids: Annotated[list[int], typer.Argument(metavar="FLAG...", help="Numbers of the flags.", show_default=False)],
    to: Annotated[str, typer.Option("--to", help="Login or name; empty for nobody in particular.")],
    by: By,
    why: Annotated[str, typer.Option("--why", help="Why.")] = "",
    *,
    server: Server = DEFAULT_SERVER,
) -> None:
    """Say who is to look after flags; `imu-health flags --assigned NAME` finds them."""
    with connect(server) as client:
        for id in ids:
            screen().print(_line(client.post(f"/flags/{id}/assign", {"to": to, "by": by, "why": why})))


def _is_open(flag: dict[str, Any]) -> bool:
    """The API has open flags first."""
    return bool(flag["state"] != FlagState.RESOLVED)


def _handle(id: int, what: str, by: str, why: str, server: str) -> None:
    with connect(server) as client:
        flag = client.post(f"/flags/{id}/{what}", {"by": by, "why": why})
    screen().print(_line(flag))


def _line(flag: dict[str, Any]) -> str:
    return f"Flag {flag['id']}  [bold]{escape(flag['unit'])}[/]  {_state(flag)}  {escape(said(flag['summary']))}"


def _state(flag: dict[str, Any]) -> str:
    state = FlagState(flag["state"])
    return f"[{COLOURS[state]}]{state.value}[/]"


def _table(found: list[dict[str, Any]]) -> Table:
    table = table_of("flag", "unit", "state", "since", "who", "where", "what", right=("flag",))
    for flag in found:
        what = said(f"{flag['summary']} {flag['proposal']}".strip())
        since, place = flag["raised_at"][:10], escape(flag["place"])
        table.add_row(
            str(flag["id"]), escape(flag["unit"]), _state(flag), since, escape(flag["assignee"]), place, escape(what)
        )
    return table
