"""U1 and U7: the first start on an empty machine as `make run` makes it, and what a service takes that waits.

From the command to the first page that answers, and to the demonstration being whole. Memory is that of a service on an
empty database, some seconds after its first page: the process that answers, and all its processes by what each adds to
what they share (PSS). By the clock.
"""

import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import httpx
import psutil

from benchmarks.figures import COMPILING, Felt
from benchmarks.kills.server import free_port
from benchmarks.p10_startup import COMMAND
from service.demo.cast import CAST

QUIET = 5.0
"""Seconds after which a service that nobody asks has started all that it keeps."""
BETWEEN = 0.05
"""Seconds between two looks."""
NOTE = """
U1: the demonstration is stored beside the first pages.

U7 misses its target. By what each import adds, numpy and scipy are a quarter of it, the service's own modules with
their routes and models a fifth, SQLAlchemy, FastAPI, pydantic and Alembic together as much. Charts, tables, paper,
readers of files and the demonstration are not among it until somebody asks for them.
"""


@dataclass(frozen=True)
class Started:
    """A service of its own."""

    http: httpx.Client
    process: psutil.Process
    began: float

    def page(self) -> float:
        """Seconds until its fleet page answers."""
        while True:
            try:
                if self.http.get("/", headers={"Accept": "text/html"}).is_success:
                    return time.monotonic() - self.began
            except httpx.TransportError:
                time.sleep(BETWEEN)

    def demonstration(self) -> float:
        """Seconds until it holds the whole fleet."""
        while self.http.get("/api/v1/fleet").raise_for_status().json()["units"] < len(CAST):
            time.sleep(BETWEEN)
        return time.monotonic() - self.began


@contextmanager
def started(*options: str) -> Iterator[Started]:
    """`imu-health serve` on an empty folder."""
    port = free_port()
    with tempfile.TemporaryDirectory(prefix="imu-u1-", ignore_cleanup_errors=True) as folder:
        command = (COMMAND, "serve", "--port", str(port), "--data-folder", folder, *options)
        began = time.monotonic()
        null = subprocess.DEVNULL
        process = subprocess.Popen(command, env=COMPILING, cwd=folder, stdout=null, stderr=null)
        try:
            with httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=60) as http:
                yield Started(http, psutil.Process(process.pid), began)
        finally:
            process.terminate()
            process.wait()


def memory(own: psutil.Process) -> tuple[float, float]:
    """MB: of one process, and of it with all that it has started."""
    every = [own, *own.children(recursive=True)]
    return own.memory_info().rss / 1e6, sum(one.memory_full_info().pss for one in every) / 1e6


def run() -> Iterator[Felt]:
    """Memory first: its start compiles what is not compiled yet."""
    with started() as service:
        service.page()
        time.sleep(QUIET)
        answering, all_of_it = memory(service.process)
    with started("--demo") as service:
        yield Felt("U1", "from `make run` on an empty machine, set up, to the first page", service.page(), 100)
        whole = "until the demonstration is whole behind it"
        yield Felt("U1, demonstration", whole, service.demonstration(), None)
    yield Felt("U7", "memory of the service at rest, the process that answers", answering, 150, "MB")
    yield Felt(
        "U7, processes", "the same with those that diagnose and read files, shared pages once", all_of_it, None, "MB"
    )
