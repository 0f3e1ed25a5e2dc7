"""`imu-health session`, `imu-health withdraw-service`: records are taken back, accepted, chosen; nothing is erased."""

from typing import Annotated, Any

import typer
from rich.markup import escape

from service.client import connect
from service.commands.console import DEFAULT_SERVER, Server, screen

session = typer.Typer(
    name="session",
    add_completion=False,
    no_args_is_help=True,
    help="Withdraw a session, accept it again, or choose it as the reference of its time.",
)
By = Annotated[str, typer.Option("--by", help="Your name.")]
Why = Annotated[str, typer.Option("--why", help="Why.")]
Id = Annotated[str, typer.Argument(metavar="SESSION", help="The session's id.")]


@session.command("withdraw")
def withdraw(id: Id, by: By, why: Why, server: Server = DEFAULT_SERVER) -> None:
    """Take a session back: it stays readable, and tells nothing of its unit any more."""
    with connect(server) as client:
        _show(client.post(f"/sessions/{id}/withdraw", {"by": by, "why": why}))


@session.command("accept")
def accept(id: Id, by: By, why: Why, server: Server = DEFAULT_SERVER) -> None:
    """Say that a session counts that was questioned, withdrawn or superseded."""
    with connect(server) as client:
        _show(client.post(f"/sessions/{id}/accept", {"by": by, "why": why}))


@session.command("reference")
def reference(id: Id, by: By, why: Why, server: Server = DEFAULT_SERVER) -> None:
    """Choose and approve a session as what all others of its time are judged against."""
    with connect(server) as client:
        unit = client.get(f"/sessions/{id}").json()["unit"]
        _show(client.post(f"/units/{unit}/reference", {"session": id, "by": by, "why": why}))


def withdraw_service(
    number: Annotated[int, typer.Argument(metavar="SERVICE", help="Number of the service.")],
    by: By,
    why: Why,
    server: Server = DEFAULT_SERVER,
) -> None:
    """Take a service back: it stays on record and is no break any more."""
    with connect(server) as client:
        found = client.post(f"/services/{number}/withdraw", {"by": by, "why": why})
    screen().print(f"Service {found['id']}  [bold]{escape(found['unit'])}[/]  {found['kind']}  {found['state']}")


def _show(found: dict[str, Any]) -> None:
    reference = "  reference" if found["is_reference"] else ""
    line = f"Session {found['id']}  [bold]{escape(found['unit'])}[/]  {found['state']}{reference}"
    screen().print(f"{line}  {escape(found['reason'])}")
