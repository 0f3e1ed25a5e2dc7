"""`imu-health service` and `imu-health note`: what was done to a unit, and remarks on its history."""

from datetime import datetime
from typing import Annotated, Any

import typer
from rich.markup import escape

from service.client import connect
from service.commands.console import DEFAULT_SERVER, Server, screen

Unit = Annotated[str, typer.Argument(metavar="UNIT", help="Serial number.")]
At = Annotated[datetime | None, typer.Option(help="When, UTC.", show_default="now")]
By = Annotated[str, typer.Option("--by", help="Your name.")]


def record(
    unit: Unit,
    kind: Annotated[str, typer.Argument(help="adjustment, repair, sensor-swap, reference or service.")],
    by: By,
    at: At = None,
    *,
    sensor: Annotated[str, typer.Option(help="The sensor that it concerns.", show_default="the whole unit")] = "",
    note: Annotated[str, typer.Option(help="What exactly.")] = "",
    server: Server = DEFAULT_SERVER,
) -> None:
    """Record a service: a break, after which the unit's next session is its new reference."""
    body = {"kind": kind, "by": by, "sensor": sensor, "note": note} | _when(at)
    _send(server, f"/units/{unit}/services", body)


def write_note(
    unit: Unit,
    text: Annotated[str, typer.Argument(metavar="TEXT", help="What is worth knowing.")],
    by: By,
    at: At = None,
    server: Server = DEFAULT_SERVER,
) -> None:
    """Write a note on a unit's history."""
    _send(server, f"/units/{unit}/notes", {"text": text, "by": by} | _when(at))


def _when(at: datetime | None) -> dict[str, Any]:
    return {} if at is None else {"at": at.isoformat()}


def _send(server: str, path: str, body: dict[str, Any]) -> None:
    with connect(server) as client:
        kept = client.post(path, body)
    what = kept.get("kind", "note")
    screen().print(f"[bold]{escape(kept['unit'])}[/]  {kept['at'][:10]}  {what} {kept['id']} recorded")
