"""`imu-health certificate`, `correction`, `export`: what is handed on of a stored session, by a running service."""

import json
from enum import StrEnum
from typing import Annotated
from urllib.parse import quote

import typer

from service.client import connect
from service.commands.console import DEFAULT_SERVER, Out, Server, deliver


class System(StrEnum):
    """Whose parameters."""

    PX4 = "px4"
    ARDUPILOT = "ardupilot"
    KALIBR = "kalibr"
    ROS2 = "ros2"


class Form(StrEnum):
    """What a certificate can be written as."""

    PDF = "pdf"
    DCC = "dcc"


Session = Annotated[str, typer.Argument(metavar="SESSION", help="The session's id, as its page's address ends.")]


def certificate(
    session: Session,
    server: Server = DEFAULT_SERVER,
    format: Annotated[Form, typer.Option("--format", help="pdf, to sign, or dcc: XML for programs.")] = Form.PDF,
    by: Annotated[str, typer.Option("--by", help="Your name, kept with the certificate's number.")] = "",
    number: Annotated[
        str, typer.Option(help="Of an approved one, as it was approved.", show_default="the latest")
    ] = "",
    out: Out = None,
) -> None:
    """Write the certificate of a session."""
    own = f"/sessions/{quote(session, safe='')}"
    path = f"{own}/certificates/{quote(number, safe='')}" if number else f"{own}/certificate"
    with connect(server) as client:
        deliver(client.get(path, format=format.value, **({} if number else {"by": by})).content, out)


def correction(session: Session, server: Server = DEFAULT_SERVER, out: Out = None) -> None:
    """Write the correction that firmware applies to readings, as JSON."""
    with connect(server) as client:
        found = client.get(f"/sessions/{quote(session, safe='')}/correction").json()
    deliver((json.dumps(found, indent=1, ensure_ascii=False) + "\n").encode(), out)


def export(
    session: Session,
    system: Annotated[System, typer.Option("--system", help="px4, ardupilot, kalibr or ros2.")],
    server: Server = DEFAULT_SERVER,
    out: Out = None,
) -> None:
    """Write the correction as parameters of PX4, ArduPilot, Kalibr or ROS 2."""
    with connect(server) as client:
        found = client.get(f"/sessions/{quote(session, safe='')}/export", system=system.value)
    deliver(found.content, out)
