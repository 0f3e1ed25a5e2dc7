"""`imu-health serve`: the service, with its schema up to date, and the demonstration fleet where it is asked for."""

import ipaddress
import socket
from typing import Annotated

import typer
import uvicorn

from service.app import create_app
from service.commands.console import progress, say
from service.commands.options import DatabaseUrl, DataFolder, settings_from
from service.demo.fill import FILES, fill, is_wanted
from service.log import write_log
from service.settings import Settings
from service.storage import Database, Files, Storage
from service.storage.schema import upgrade

LAST_ANSWERS = 10
"""Seconds that a stopping service gives the requests at hand."""


def serve(
    host: Annotated[str | None, typer.Option(help="Address to listen on.", show_default="127.0.0.1")] = None,
    port: Annotated[int | None, typer.Option(help="Port; 0 takes a free one.", show_default="8000")] = None,
    database_url: DatabaseUrl = None,
    data_folder: DataFolder = None,
    demo: Annotated[bool, typer.Option("--demo", help="Fill an empty database with simulated units.")] = False,
) -> None:
    """Start the service: schema brought up to date, pages and API on one address."""
    settings = settings_from(host=host, port=port, database_url=database_url, data_folder=data_folder)
    if not _is_loopback(settings.host):
        say(f"Listening on {settings.host}: anyone who reaches this address can read and upload, there is no sign-in.")
    upgrade(settings.database)
    if demo:
        _fill(settings)
    write_log()
    config = uvicorn.Config(
        create_app(settings),
        settings.host,
        settings.port,
        log_config=None,
        access_log=False,
        timeout_graceful_shutdown=LAST_ANSWERS,
    )
    _Server(config).run()


class _Server(uvicorn.Server):
    """Says where it listens once it does."""

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        host, port = self.servers[0].sockets[0].getsockname()[:2]
        typer.echo(f"imu-health is ready: open http://{f'[{host}]' if ':' in host else host}:{port}")


def _is_loopback(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def _fill(settings: Settings) -> None:
    """Uploads the demonstration fleet when there is nothing else in the database."""
    storage = Storage(Database(settings.database), Files(settings.files))
    if is_wanted(storage):
        say(f"Filling the empty database with a simulated demonstration fleet, {FILES} sessions.")
        with progress(FILES, "simulating, calibrating, storing") as advance:
            fill(storage, settings.coverage_factor, advance)
    storage.database.close()
