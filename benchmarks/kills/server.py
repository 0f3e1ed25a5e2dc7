"""The service as a process that can be killed; forked from one that has read the program already, so that it starts
in no time."""

import logging
import multiprocessing
import os
import signal
import socket
from dataclasses import dataclass
from multiprocessing.process import BaseProcess

import httpx

from service.app import create_app
from service.settings import Settings
from service.web.server import Server

SOON = 120.0
"""Seconds in which a service must answer after it was started, on a machine that has much else to do."""

forking = multiprocessing.get_context("forkserver")
forking.set_forkserver_preload(["service.app", "service.web.server"])


def free_port() -> int:
    """A port that nobody listens on."""
    with socket.create_server(("127.0.0.1", 0)) as found:
        port: int = found.getsockname()[1]
    return port


def serve(settings: Settings, port: int, *, beside: bool = True) -> None:
    """Serves until the process is killed; without work ``beside`` it answers requests and nothing else."""
    logging.disable()
    here = settings.model_copy(update={"port": port})
    server = Server(create_app(here), here)
    server.config.lifespan = "on" if beside else "off"
    server.run()


@dataclass
class Service:
    """A service at a fixed address, running or dead."""

    settings: Settings
    port: int
    process: BaseProcess | None = None
    beside: bool = True
    """Whether it makes diagnoses and the like beside the requests."""

    @property
    def address(self) -> str:
        """Address that it listens on."""
        return f"http://127.0.0.1:{self.port}"

    def start(self) -> None:
        """Starts it, and waits until it is ready."""
        self.process = forking.Process(target=serve, args=(self.settings, self.port), kwargs={"beside": self.beside})
        self.process.start()
        transport = httpx.HTTPTransport(retries=0)
        with httpx.Client(transport=transport) as client:
            for _ in range(int(SOON / 0.05)):
                try:
                    if client.get(f"{self.address}/readyz", timeout=SOON).status_code == 200:
                        return
                except httpx.TransportError:
                    self.process.join(0.05)
        raise TimeoutError("the service did not become ready")

    def kill(self) -> None:
        """`kill -9`."""
        assert self.process is not None
        assert self.process.pid is not None
        os.kill(self.process.pid, signal.SIGKILL)
        self.process.join()
