"""The HTTP server of the application."""

import socket

import uvicorn
from fastapi import FastAPI

from service.kit.limits import in_force
from service.settings import Settings
from service.web.stopping import RequestGate

BACKGROUND_SECONDS = 5
"""Seconds that a stopping service gives to background tasks after the last answer; the next start resumes them."""


class Server(uvicorn.Server):
    """Stops in two steps: new requests are rejected and running ones finish, then connections are closed."""

    def __init__(self, app: FastAPI, settings: Settings) -> None:
        super().__init__(server_config(app, settings))
        self._gate: RequestGate = app.state.gate
        self._within = settings.stop_seconds

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """Ends the service within the configured time."""
        await self._gate.empty(self._within)
        await super().shutdown(sockets)


def server_config(app: FastAPI, settings: Settings) -> uvicorn.Config:
    """Address and number of connections of the server."""
    return uvicorn.Config(
        app,
        settings.host,
        settings.port,
        http="h11",
        limit_concurrency=in_force().connections + 1,  # which is refused itself
        log_config=None,
        access_log=False,
        forwarded_allow_ips=[str(network) for network in settings.trusted_proxies],
        timeout_graceful_shutdown=BACKGROUND_SECONDS,
    )


def address_of(server: uvicorn.Server) -> str:
    """Address of a server that has started."""
    listening: socket.socket = server.servers[0].sockets[0]
    host, port = listening.getsockname()[:2]
    return f"http://{f'[{host}]' if ':' in host else host}:{port}"
