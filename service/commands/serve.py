"""`imu-health serve`: the service, with an upgraded schema, and the demonstration fleet if requested."""

import socket
from collections.abc import Callable
from typing import TYPE_CHECKING, Annotated

import typer

from estimator.on_demand import ModuleOnDemand
from service.app import create_app, utc_now
from service.commands.options import DatabaseUrl, DataFolder, settings_from
from service.commands.speech import say
from service.kit.filling import Filling
from service.kit.log import write_log
from service.opening import open_database
from service.people.changes import make_link
from service.people.store import Accounts
from service.settings import Settings
from service.storage import Files, Storage
from service.storage.folders import require_writable
from service.storage.schema import upgrade
from service.web.hosts import hosts_of
from service.web.server import Server, address_of

if TYPE_CHECKING:
    from service.demo import fill as demo_fleet
else:
    demo_fleet = ModuleOnDemand("service.demo.fill")

STARTED = "who started the service"
"""Name in the audit trail."""
FIRST = "To make everybody sign in, open this within an hour and make the first account:"


def serve(
    host: Annotated[str | None, typer.Option(help="Address to listen on.", show_default="127.0.0.1")] = None,
    port: Annotated[int | None, typer.Option(help="Port; 0 takes a free one.", show_default="8000")] = None,
    database_url: DatabaseUrl = None,
    data_folder: DataFolder = None,
    demo: Annotated[bool, typer.Option("--demo", help="Fill an empty database with simulated units.")] = False,
) -> None:
    """Start the service: schema brought up to date, pages and API on one address."""
    settings = settings_from(host=host, port=port, database_url=database_url, data_folder=data_folder)
    if settings.sign_in == "off" and not settings.is_local:
        say(f"Listening on {settings.host} without sign-in: whoever reaches this address may do everything.")
    if hosts_of(settings).any_address:
        say("It answers to IP addresses only: set its name in IMU_HEALTH_PUBLIC_URL or IMU_HEALTH_ALLOWED_HOSTS.")
    require_writable(settings.files)
    upgrade(settings.database)
    filling = _demonstration(settings) if demo else None
    write_log()
    _Server(settings, _first_link(settings), filling).run()


class _Server(Server):
    """Prints its address once it listens, and how to make the first account."""

    def __init__(self, settings: Settings, first: str | None, filling: Filling | None) -> None:
        super().__init__(create_app(settings, filling=filling), settings)
        self._first = first

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        address = address_of(self)
        typer.echo(f"imu-health is ready: open {address}")
        if self._first is not None:
            typer.echo(f"{FIRST} {address}/sign-in/{self._first}")


def _first_link(settings: Settings) -> str | None:
    """The secret of the link that makes the first account; None once there is one: start messages are kept in logs, and
    must not allow a reset of anybody's password."""
    if settings.sign_in == "off":
        return None
    storage = Storage(open_database(settings.database), Files(settings.files))
    with storage.database.reading() as store:
        has_accounts = Accounts(store).any()
    secret = None if has_accounts else make_link(storage, None, utc_now(), STARTED)
    storage.database.close()
    return secret


def _demonstration(settings: Settings) -> Filling | None:
    """The filling of an empty database with the demonstration fleet; None where it holds units already."""
    storage = Storage(open_database(settings.database), Files(settings.files))
    is_wanted = demo_fleet.is_wanted(storage)
    storage.database.close()
    if not is_wanted:
        return None

    def store(advance: Callable[[], None]) -> None:
        """Stores every session of the fleet."""
        filled = Storage(open_database(settings.database), Files(settings.files))
        try:
            demo_fleet.fill(filled, settings.coverage_factor, advance)
        finally:
            filled.database.close()

    say(
        f"Filling the empty database with a simulated demonstration fleet, {demo_fleet.FILES} sessions; "
        "the fleet's page says how far it is."
    )
    return Filling(store, demo_fleet.FILES)
