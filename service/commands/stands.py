"""`imu-health stand-dcc`: what a running service keeps of a stand's Digital Calibration Certificate."""

from datetime import datetime
from pathlib import Path
from typing import Annotated
from urllib.parse import quote

import typer
from rich.markup import escape

from estimator.reading.setting import ARCSEC
from service.client import connect
from service.commands.api import DAYS, By
from service.commands.console import DEFAULT_SERVER, Server, screen, usable
from service.commands.speech import output_language


def stand_dcc(
    stand: Annotated[str, typer.Argument(metavar="STAND", help="Its name, as session files give it.")],
    file: Annotated[Path, typer.Argument(metavar="FILE", help="The certificate, XML.")],
    by: By,
    valid_until: Annotated[
        datetime | None, typer.Option(formats=DAYS, help="The last day, where the document does not state it.")
    ] = None,
    server: Server = DEFAULT_SERVER,
) -> None:
    """Record a stand's certificate from its document."""
    query = {"by": by} | ({} if valid_until is None else {"valid_until": valid_until.date().isoformat()})
    with usable(file), connect(server, language=output_language()) as client:
        address = f"/stands/{quote(stand, safe='')}/certificate-document"
        sent = {"content": file.read_bytes(), "headers": {"Content-Type": "application/xml"}, "params": query}
        read = client.answer("PUT", address, **sent).json()
    kept = read["certificate"]
    screen().print(f"[bold]{escape(kept['number'])}[/]  {escape(kept['issued_by'])}  {kept['valid_until']}")
    for error in read["errors"]:
        screen().print(f"  {error['name']}  {error['sigma'] / ARCSEC:.3g} arcsec")
