"""`imu-health views`: the views of the pages that were saved under a name."""

from typing import Any

from rich.markup import escape
from rich.table import Table

from service.client import connect
from service.commands.console import DEFAULT_SERVER, AsJson, Server, print_json, screen


def views(server: Server = DEFAULT_SERVER, as_json: AsJson = False) -> None:
    """List the views of the pages that were saved under a name, with their addresses."""
    with connect(server) as client:
        found = client.get("/views").json()["views"]
    if as_json:
        for view in found:
            print_json(view)
    else:
        screen().print(_table(found, server.rstrip("/")) if found else "No view is saved yet.")


def _table(found: list[dict[str, Any]], server: str) -> Table:
    table = Table(box=None, pad_edge=False, header_style="bold", padding=(0, 2, 0, 0))
    for heading in ("view", "page", "name", "address"):
        table.add_column(heading, justify="right" if heading == "view" else "left", overflow="fold")
    for view in found:
        table.add_row(str(view["id"]), view["page"], escape(view["name"]), escape(f"{server}{view['url']}"))
    return table
