"""The HTTP server that stands before the application."""

import socket

import uvicorn
from fastapi import FastAPI

from service.kit.limits import in_force
from service.settings import Settings
from service.web.stopping import Door

LAST_WORDS = 5
"""Seconds that a stopping service gives, after the last answer, what runs after it; the next start takes it up."""


class Server(uvicorn.Server):
    """Stops in two steps: first nobody is let in and all who are inside finish, then connections are closed."""

    def __init__(self, app: FastAPI, settings: Settings) -> None:
        super().__init__(server_config(app, settings))
        self._door: Door = app.state.door
        self._within = settings.stop_seconds

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """Ends the service within the time that the settings give."""
        await self._door.empty(self._within)
        await super().shutdown(sockets)


def server_config(app: FastAPI, settings: Settings) -> uvicorn.Config:
    """How the application is served: where, and on how many connections."""
    return uvicorn.Config(
        app,
        settings.host,
        settings.port,
        http="h11",
        limit_concurrency=in_force().connections + 1,  # which is refused itself
        log_config=None,
        access_log=False,
        forwarded_allow_ips=[str(network) for network in settings.trusted_proxies],
        timeout_graceful_shutdown=LAST_WORDS,
    )


def address_of(server: uvicorn.Server) -> str:
    """Where a server that has started listens."""
    listening: socket.socket = server.servers[0].sockets[0]
    host, port = listening.getsockname()[:2]
    return f"http://{f'[{host}]' if ':' in host else host}:{port}"
