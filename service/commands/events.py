"""`imu-health service` and `imu-health note`: what was done to a unit, and remarks on its history."""

from datetime import datetime
from typing import Annotated, Any

import typer
from rich.markup import escape

from service.client import connect
from service.commands.console import DEFAULT_SERVER, Files, Server, screen
from service.commands.place import in_path, is_session

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
    _send(server, f"/units/{in_path(unit)}/services", body)


def attach_files(
    files: Files,
    to: Annotated[str, typer.Option("--to", metavar="UNIT|SESSION", help="Serial number, or id of a session.")],
    by: By,
    text: Annotated[str, typer.Option("--text", help="What they show.")] = "",
    *,
    server: Server = DEFAULT_SERVER,
) -> None:
    """Attach files to a unit or a session: photographs, protocols. They are kept as they are and never opened."""
    with connect(server) as client:
        home = "session" if is_session(client, to) else "unit"
        for file in files:
            form = {home: to, "by": by, "text": text}
            kept = client.answer("POST", "/attachments", files={"file": (file.name, file.read_bytes())}, data=form)
            found = kept.json()
            screen().print(f"[bold]{escape(found['unit'])}[/]  attachment {found['id']}  {escape(found['filename'])}")


def write_note(
    unit: Unit,
    text: Annotated[str, typer.Argument(metavar="TEXT", help="What is worth knowing.")],
    by: By,
    at: At = None,
    server: Server = DEFAULT_SERVER,
) -> None:
    """Write a note on a unit's history, or on a session."""
    with connect(server) as client:
        if is_session(client, unit):
            if at is not None:
                raise typer.BadParameter("a note on a session has the date of the session", param_hint="--at")
            _print(client.post(f"/sessions/{unit}/notes", {"text": text, "by": by}))
        else:
            _print(client.post(f"/units/{in_path(unit)}/notes", {"text": text, "by": by} | _when(at)))


def _when(at: datetime | None) -> dict[str, Any]:
    return {} if at is None else {"at": at.isoformat()}


def _send(server: str, path: str, body: dict[str, Any]) -> None:
    with connect(server) as client:
        _print(client.post(path, body))


def _print(kept: dict[str, Any]) -> None:
    what = kept.get("kind", "note")
    screen().print(f"[bold]{escape(kept['unit'])}[/]  {kept['at'][:10]}  {what} {kept['id']} recorded")
