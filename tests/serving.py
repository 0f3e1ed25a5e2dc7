"""The service over real HTTP, on a free port of this machine."""

import asyncio
import socket
import ssl
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from threading import Event, Thread

import httpx
import uvicorn
from fastapi import FastAPI

from service.app import create_app
from service.kit import limits
from service.kit.limits import Limits
from service.settings import Settings
from service.web.server import address_of, server_config
from tests.patience import LONG

TLS = ssl.create_default_context()
"""Read once: every client that reads the certificates of this machine anew takes longer for it than for its test."""


class Server(uvicorn.Server):
    """Says at once that it has started, and stops as soon as it is told to, where uvicorn looks ten times a second."""

    def __init__(self, app: FastAPI) -> None:
        settings: Settings = app.state.application.settings
        super().__init__(server_config(app, settings.model_copy(update={"host": "127.0.0.1", "port": 0})))
        self.settled = Event()
        """Whether it has started, or never will."""

    def work(self) -> None:
        """Serves until it is told to stop."""
        try:
            self.run()
        finally:
            self.settled.set()

    async def main_loop(self) -> None:
        self._loop, self._end = asyncio.get_running_loop(), asyncio.Event()
        await self.on_tick(0)
        self.settled.set()
        await self._end.wait()

    def stop(self) -> None:
        """Ends the main loop."""
        self._loop.call_soon_threadsafe(self._end.set)

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        for server in self.servers:
            server.close()
        for connection in list(self.server_state.connections):
            connection.shutdown()
        await asyncio.gather(*self.server_state.tasks)
        await self.lifespan.shutdown()


@contextmanager
def running(app: FastAPI) -> Iterator[str]:
    """The address of an application that runs until the block ends."""
    server = Server(app)
    thread = Thread(target=server.work, daemon=True)
    thread.start()
    server.settled.wait()
    assert server.started, "the service did not start"
    try:
        yield address_of(server)
    finally:
        server.stop()
        thread.join()


@contextmanager
def other_limits(**changes: float) -> Iterator[Limits]:
    """Limits of a smaller machine than there is, in force until the block ends."""
    usual = limits.in_force()
    most = replace(usual, **changes)
    limits.use(most)
    try:
        yield most
    finally:
        limits.use(usual)


@contextmanager
def serving(settings: Settings, **changes: float) -> Iterator[str]:
    """The address of the service on a database whose schema is up to date; ``changes``: of its limits."""
    with other_limits(**changes) as most, running(create_app(settings, most=most)) as address:
        yield address


@contextmanager
def http_client(app: FastAPI) -> Iterator[httpx.Client]:
    """HTTP to a running application."""
    with running(app) as address, httpx.Client(base_url=address, timeout=LONG, verify=TLS) as client:
        yield client


@contextmanager
def limited_client(settings: Settings, **changes: float) -> Iterator[httpx.Client]:
    """HTTP to a service with other limits."""
    with other_limits(**changes) as most, http_client(create_app(settings, most=most)) as client:
        yield client
