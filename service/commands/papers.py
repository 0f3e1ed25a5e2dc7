"""`imu-health customer` and `stand-certificate`: what certificates name besides the measurement."""

from datetime import datetime
from typing import Annotated
from urllib.parse import quote

import typer
from rich.markup import escape

from service.client import connect
from service.commands.console import DEFAULT_SERVER, Server, screen

By = Annotated[str, typer.Option("--by", help="Your name.")]
DAYS = ["%Y-%m-%d"]
"""How a day is written."""


def customer(
    unit: Annotated[str, typer.Argument(metavar="UNIT", help="Serial number.")],
    name: Annotated[str, typer.Argument(metavar="NAME", help="For whom it is calibrated.")],
    by: By,
    address: Annotated[str, typer.Option(help="Where they can be reached.")] = "",
    server: Server = DEFAULT_SERVER,
) -> None:
    """Record for whom a unit is calibrated; its certificates name them."""
    with connect(server) as client:
        path = f"/units/{quote(unit, safe='')}/customer"
        kept = client.put(path, {"name": name, "address": address, "by": by})
    screen().print(
        f"[bold]{escape(unit)}[/]  {escape(kept['name'])}, {escape(kept['address'] or 'address not stated')}"
    )


def stand_certificate(
    stand: Annotated[str, typer.Argument(metavar="STAND", help="Its name, as session files give it.")],
    number: Annotated[str, typer.Option(help="As printed on the certificate.")],
    issued_by: Annotated[str, typer.Option(help="The laboratory that calibrated the stand.")],
    issued_on: Annotated[datetime, typer.Option(formats=DAYS, help="From this day on it speaks for the stand.")],
    valid_until: Annotated[datetime, typer.Option(formats=DAYS, help="The last day on which it holds.")],
    *,
    by: By,
    server: Server = DEFAULT_SERVER,
) -> None:
    """Record the certificate of a stand's own calibration, which every session on it hangs on."""
    body = {"number": number, "issued_by": issued_by, "by": by} | {
        name: f"{day:%Y-%m-%d}" for name, day in (("issued_on", issued_on), ("valid_until", valid_until))
    }
    with connect(server) as client:
        kept = client.put(f"/stands/{quote(stand, safe='')}/certificate", body)
    screen().print(f"[bold]{escape(stand)}[/]  {escape(kept['number'])}, valid until {kept['valid_until']}")
