"""`imu-health sign` signs a certificate; `imu-health seal` makes a key for trying electronic seals."""

import os
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated
from urllib.parse import quote

import typer
from rich.markup import escape

from service.client import connect
from service.commands.console import DEFAULT_SERVER, Server, screen
from service.commands.documents import Session
from service.commands.speech import output_language, say
from service.errors import ConflictError
from service.papers.changes import NOT_ISSUED
from service.papers.records import Meaning
from service.papers.sealing import seal_room
from service.papers.words import STATES
from service.settings import Settings

OWNER_ONLY = 0o600
"""Permissions of a file with a key."""
seal = typer.Typer(name="seal", add_completion=False, no_args_is_help=True, help="The laboratory's electronic seal.")


def sign(
    session: Session,
    meaning: Annotated[Meaning, typer.Option(help="What your signature says.", show_default=False)],
    number: Annotated[str, typer.Option(help="Of the certificate that you read.", show_default="the latest")] = "",
    server: Server = DEFAULT_SERVER,
) -> None:
    """Sign the certificate of a session: reviewed, then approved by somebody else. Asks for your password."""
    path = f"/sessions/{quote(session, safe='')}/certificate"
    with connect(server, language=output_language()) as client:
        issued = client.get(f"{path}s").json()["certificates"]
        if not issued:
            raise ConflictError(NOT_ISSUED)
        certificate = number or issued[-1]["number"]
        say(f"Certificate {certificate}: {STATES[meaning]}")
        password = typer.prompt("Your password", hide_input=True, err=True)
        signature = client.post(f"{path}/signatures", {"number": certificate, "meaning": meaning, "password": password})
    screen().print(f"[bold]{escape(signature['certificate'])}[/]  {meaning} by {escape(signature['name'])}")


@seal.callback()
def _group() -> None:
    """The laboratory's electronic seal."""


@seal.command("trial")
def make_trial(
    out: Annotated[Path, typer.Option(help="File to write; one that is there stays as it is.", show_default=False)],
) -> None:
    """Make a key that nobody trusts, to try seals with: it says so in its name, and holds for ninety days."""
    key: bytes = seal_room("trial").make_trial_key(Settings().laboratory_name, datetime.now(UTC))
    file = os.open(out, os.O_WRONLY | os.O_CREAT | os.O_EXCL, OWNER_ONLY)
    with os.fdopen(file, "wb") as opened:
        opened.write(key)
    say(f"{out}: a key for trial. Start the service with IMU_HEALTH_SEAL_KEY_FILE={out}.")
