"""`imu-health usable`: may a unit be used? The exit code says it to scripts."""

from typing import Annotated
from urllib.parse import quote

import typer
from rich.markup import escape

from service.client import connect
from service.commands.console import DEFAULT_SERVER, AsJson, Server, print_json, screen
from service.commands.exits import FAILED
from service.commands.speech import said

Unit = Annotated[str, typer.Argument(metavar="UNIT", help="Serial number.")]


def usable(unit: Unit, server: Server = DEFAULT_SERVER, as_json: AsJson = False) -> None:
    """Say whether a unit may be used: exit code 0 for yes, 1 for no, for a unit nobody knows, and in doubt."""
    with connect(server) as client:
        answer = client.get(f"/units/{quote(unit, safe='')}/usable").json()
    if as_json:
        print_json(answer)
    else:
        word = f"[green]{said('usable')}[/]" if answer["usable"] else f"[bold red]{said('not usable')}[/]"
        lines = (answer["why"], *answer["reasons"][1:], *(f"But: {line}" for line in answer["reservations"]))
        screen().print(f"[bold]{escape(unit)}[/]  {word}", *(escape(said(line)) for line in lines), sep="\n  ")
    if not answer["usable"]:
        raise typer.Exit(FAILED)
