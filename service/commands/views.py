"""`imu-health views`: the views of the pages that were saved under a name."""

from typing import Any

from rich.markup import escape
from rich.table import Table

from service.client import connect
from service.commands.console import DEFAULT_SERVER, Server
from service.commands.listing import AsLines, FormOf, Listing, table_of


def views(server: Server = DEFAULT_SERVER, form: FormOf = None, as_json: AsLines = False) -> None:
    """List the views of the pages that were saved under a name, with their addresses."""
    with connect(server) as client:
        found = client.get("/views").json()["views"]
    shown = Listing(form, as_json)
    shown.show(found, lambda: _table(found, server.rstrip("/")) if found else "No view is saved yet.")


def _table(found: list[dict[str, Any]], server: str) -> Table:
    table = table_of("view", "page", "name", "address", right=("view",))
    for view in found:
        table.add_row(str(view["id"]), view["page"], escape(view["name"]), escape(f"{server}{view['url']}"))
    return table
