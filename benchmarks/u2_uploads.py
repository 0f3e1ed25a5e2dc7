"""U2 and U3: how long an upload waits for its verdict, and the verdict for its diagnosis.

Clients are threads of this process, over connections that they keep; the service runs as it comes: one process with
those beside it, SQLite. Every upload is another session of one of some units, later than the ones before. By the clock.
"""

import json
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from http.client import HTTPConnection
from itertools import count
from math import ceil
from pathlib import Path
from typing import Any

from benchmarks.figures import Felt
from benchmarks.kills.server import Service, free_port
from service.settings import Settings
from service.storage.schema import upgrade
from tests.service.made_sessions import session_bytes

SECONDS = 8.0
"""Seconds that each number of clients uploads."""
UNITS = 8
"""Units of each client."""
READ = 20
"""Uploads whose diagnosis is waited for, one after another."""
WORK = "from an upload to its verdict, 24 × 2 readings of 6 sensors, "
START = datetime(2020, 1, 1, tzinfo=UTC)
numbers = count()
"""Numbers of the uploads of this run: no two are the same."""
NOTE = """
U2: on a machine that does much else one client waits 0.6 m, as the service shares its cores; these figures are of a
quiet one.
"""


@dataclass(frozen=True)
class Client:
    """A client that uploads without pause."""

    port: int
    number: int
    document: dict[str, Any]

    def upload_until(self, end: float) -> list[float | None]:
        """Seconds of every upload; None of one that was asked to try again."""
        connection, taken = HTTPConnection("127.0.0.1", self.port, timeout=120), list[float | None]()
        while time.monotonic() < end:
            body = self.body()
            began = time.monotonic()
            is_stored = bool(self.post(connection, body))
            taken.append(time.monotonic() - began if is_stored else None)
        connection.close()
        return taken

    def body(self) -> bytes:
        """A session later than the ones before."""
        at = next(numbers)
        own = {
            "unit": f"U2-{self.number}-{at % UNITS}",
            "started_at": (START + timedelta(minutes=at)).isoformat(),
            "notes": f"upload {at}",
        }
        return json.dumps(self.document | own).encode()

    def post(self, connection: HTTPConnection, body: bytes) -> dict[str, Any]:
        """The answer; empty where the service asked to try again."""
        connection.request("POST", "/api/v1/sessions", body, {"Content-Type": "application/json"})
        response = connection.getresponse()
        answer: dict[str, Any] = json.loads(response.read())
        assert response.status in (201, 503), answer
        return answer if response.status == 201 else {}


@contextmanager
def serving(folder: str) -> Iterator[int]:
    """The port of a service on a new database."""
    settings = Settings(data_folder=Path(folder), database_url=f"sqlite:///{folder}/{next(numbers)}.sqlite")
    upgrade(settings.database)
    service = Service(settings, free_port())
    service.start()
    try:
        yield service.port
    finally:
        service.kill()


def under_load(port: int, clients: int, document: dict[str, Any]) -> list[float | None]:
    """Every upload of so many clients."""
    end = time.monotonic() + SECONDS
    with ThreadPoolExecutor(clients) as pool:
        jobs = [pool.submit(Client(port, number, document).upload_until, end) for number in range(clients)]
        return [one for job in jobs for one in job.result()]


def delays(port: int, document: dict[str, Any]) -> list[float]:
    """Seconds from the answer to an upload to its diagnosis, one after another."""
    client, taken = Client(port, 99, document), []
    connection = HTTPConnection("127.0.0.1", port, timeout=120)
    for _ in range(READ):
        id = client.post(connection, client.body())["id"]
        began, status = time.monotonic(), 202
        while status == 202:
            connection.request("GET", f"/api/v1/sessions/{id}/diagnosis")
            response = connection.getresponse()
            response.read()
            status = response.status
        taken.append(time.monotonic() - began)
    return taken


def at(taken: list[float], share: float) -> float:
    """The quantile: no more than ``share`` of all took less."""
    return sorted(taken)[ceil(share * len(taken)) - 1]


def run() -> Iterator[Felt]:
    """Each number of clients meets a service of its own."""
    document = json.loads(session_bytes())
    with tempfile.TemporaryDirectory(prefix="imu-u2-", ignore_cleanup_errors=True) as folder:
        for clients, share, most in ((1, 0.5, 0.4), (8, 0.95, 5.0), (32, 0.95, None)):
            with serving(folder) as port:
                delay = delays(port, document) if clients == 1 else []
                taken = under_load(port, clients, document)
            name = f"{clients} client{'s' if clients > 1 else ''}"
            stored = [seconds for seconds in taken if seconds is not None]
            within = "median" if share == 0.5 else f"{share:.0%}"
            yield Felt(f"U2, {name}", f"{WORK}{name}, {within}", at(stored, share), most)
            if delay:
                yield Felt("U3", "from a verdict to its diagnosis, 95%", at(delay, 0.95), 15)
        yield Felt("U2, refused", f"uploads of {name} that were refused, of {len(taken)}", taken.count(None), 0, "")
