"""`imu-health open`: the page of a unit or a session, in the browser."""

import webbrowser
from typing import Annotated

import typer

from service.client import connect
from service.commands.console import DEFAULT_SERVER, Server
from service.commands.place import in_path, is_session


def open_page(
    what: Annotated[
        str | None,
        typer.Argument(metavar="[UNIT|SESSION]", help="Serial number, or id of a session.", show_default="fleet"),
    ] = None,
    server: Server = DEFAULT_SERVER,
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="Print the address alone.")] = True,
) -> None:
    """Open the page of a unit or a session in the browser, and print its address; without one the fleet."""
    address = server.rstrip("/")
    with connect(server) as client:
        if what is None:
            client.get("/me")
            address += "/"
        elif is_session(client, what):
            address += f"/sessions/{what}"
        else:
            client.get(f"/units/{in_path(what)}")
            address += f"/units/{in_path(what)}"
    typer.echo(address)
    if browser:
        webbrowser.open(address)
