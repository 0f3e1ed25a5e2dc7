"""The service over real HTTP, on a free port of this machine."""

from collections.abc import Iterator
from contextlib import contextmanager
from threading import Thread
from time import sleep

import httpx
import uvicorn
from fastapi import FastAPI

from service.app import create_app
from service.settings import Settings


@contextmanager
def running(app: FastAPI) -> Iterator[str]:
    """The address of an application that runs until the block ends."""
    server = uvicorn.Server(uvicorn.Config(app, port=0, log_level="warning"))
    thread = Thread(target=server.run, daemon=True)
    thread.start()
    while not server.started:
        assert thread.is_alive(), "the service did not start"
        sleep(0.02)
    port = server.servers[0].sockets[0].getsockname()[1]
    try:
        yield f"http://127.0.0.1:{port}"
    finally:
        server.should_exit = True
        thread.join()


@contextmanager
def serving(settings: Settings) -> Iterator[str]:
    """The address of the service on a database whose schema is up to date."""
    with running(create_app(settings)) as address:
        yield address


@contextmanager
def http_client(app: FastAPI) -> Iterator[httpx.Client]:
    """HTTP to a running application."""
    with running(app) as address, httpx.Client(base_url=address, timeout=60) as client:
        yield client
