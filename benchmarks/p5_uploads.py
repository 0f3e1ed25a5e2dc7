"""P5: uploads answered with their verdict after a durable commit, against a bare endpoint that commits one row.

The peer is a FastAPI endpoint that parses the same JSON and commits its bytes in one row, on the same engine with the
same durability. Both are processes of their own; clients are threads of this one, over connections that they keep. The
two are driven in turn, so that a busy machine slows both. Every upload is another session of one of some units, later
than the ones before; diagnoses follow in processes of the service, on the same cores.

How services share work is measured without those processes: two cores have room for two services, and for nothing
beside. What an upload takes of the processor is told too, which other programs on the machine hardly change.
"""

import json
import multiprocessing
import sqlite3
import statistics
import tempfile
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from functools import partial
from http.client import HTTPConnection
from itertools import count
from pathlib import Path
from typing import Any

import psutil
import uvicorn
from fastapi import FastAPI, Request

from benchmarks.figures import Figure
from benchmarks.kills.server import Service, free_port
from service.settings import Settings
from service.storage.schema import upgrade
from tests.service.made_sessions import session_bytes

SECONDS = 6.0
"""That each of the two is driven at a time."""
ROUNDS = 2
"""Times that each is driven."""
CLIENTS = (1, 2, 8)
UNITS = 8
"""Of each client."""
READ = 15
"""Uploads whose diagnosis is waited for, one after another."""
WORK = "upload one session, 6 sensors × 24 positions × 2 runs, {clients}"
PEER = "bare FastAPI endpoint that parses the same JSON and commits one row"
START = datetime(2020, 1, 1, tzinfo=UTC)
numbers = count()
"""Of the uploads of this run: no two are the same."""
NOTE = """
P5 is taken by the clock, its row of the processor apart, and misses its target: an upload does far more than five times
the peer's work. By `python -m benchmarks.upload_parts` the verdict of 24 parameters, freed of what all sensors did
together, is a fifth of it, the calibration's document of 63 kB with its rows a tenth, what the database's driver does
for some forty statements another tenth, parsing, checking and calibrating a twentieth. The rest is making statements
and records in Python, a file that is durable before the database knows of it, and a commit; the peer has one statement
and one commit. How services share the cores is measured without the processes that diagnose, which stand back behind
requests and would still want a core each. What one service waits for another is its transaction, the smaller part of
an upload: the verdict is made before it.
"""


def serve_bare(folder: str, port: int) -> None:
    """The peer."""
    connection = sqlite3.connect(Path(folder) / "bare.sqlite", check_same_thread=False, isolation_level=None)
    for pragma in ("journal_mode=WAL", "synchronous=FULL"):
        connection.execute(f"PRAGMA {pragma}")
    connection.execute("CREATE TABLE sessions (id INTEGER PRIMARY KEY, unit TEXT, content BLOB)")
    app = FastAPI()

    @app.post("/api/v1/sessions", status_code=201)
    async def take(request: Request) -> dict[str, Any]:
        content = await request.body()
        unit = json.loads(content)["unit"]
        connection.execute("INSERT INTO sessions (unit, content) VALUES (?, ?)", (unit, content))
        return {"unit": unit}

    uvicorn.run(app, port=port, log_level="critical", access_log=False)


@contextmanager
def bare(folder: str) -> Iterator[int]:
    """The peer's port."""
    port = free_port()
    process = multiprocessing.get_context("spawn").Process(target=serve_bare, args=(folder, port), daemon=True)
    process.start()
    until_it_answers(port)
    try:
        yield port
    finally:
        process.kill()
        process.join()


def until_it_answers(port: int) -> None:
    """Waits for a service that starts."""
    for _ in range(600):
        try:
            HTTPConnection("127.0.0.1", port, timeout=1).connect()
        except ConnectionError:
            time.sleep(0.05)
        else:
            return
    raise TimeoutError("the peer did not start")


@dataclass(frozen=True)
class Client:
    """One that uploads without pause."""

    port: int
    number: int
    document: dict[str, Any]

    def upload_until(self, end: float) -> list[float]:
        """Seconds of every upload that was answered."""
        connection, taken = HTTPConnection("127.0.0.1", self.port, timeout=120), []
        while time.monotonic() < end:
            body = self.body()
            began = time.monotonic()
            if self.post(connection, body):
                taken.append(time.monotonic() - began)
        connection.close()
        return taken

    def body(self) -> bytes:
        """A session later than the ones before."""
        at = next(numbers)
        own = {
            "unit": f"P5-{self.number}-{at % UNITS}",
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


def rate(ports: tuple[int, ...], clients: int, document: dict[str, Any]) -> float:
    """Uploads a second of so many clients, spread over services."""
    end = time.monotonic() + SECONDS
    began = time.monotonic()
    with ThreadPoolExecutor(clients) as pool:
        jobs = [
            pool.submit(Client(ports[number % len(ports)], number, document).upload_until, end)
            for number in range(clients)
        ]
        done = sum(len(job.result()) for job in jobs)
    return done / (time.monotonic() - began)


def in_turn(ours: Callable[[], float], theirs: Callable[[], float]) -> tuple[float, float]:
    """Median rates of both."""
    rates = [(ours(), theirs()) for _ in range(ROUNDS)]
    return statistics.median(r[0] for r in rates), statistics.median(r[1] for r in rates)


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
    return sorted(taken)


@contextmanager
def services(folder: str, how_many: int, *, beside: bool = True) -> Iterator[tuple[int, ...]]:
    """Ports of services on one new database, with the processes that work beside their requests, or without."""
    settings = Settings(data_folder=Path(folder), database_url=f"sqlite:///{folder}/{next(numbers)}.sqlite")
    upgrade(settings.database)
    started = [Service(settings, free_port(), beside=beside) for _ in range(how_many)]
    for service in started:
        service.start()
    try:
        yield tuple(service.port for service in started)
    finally:
        for service in started:
            service.kill()


def processor(port: int) -> float:
    """Seconds of the processor that the process that listens on a port has taken so far, without its children."""
    (own,) = {c.pid for c in psutil.net_connections("tcp") if c.status == "LISTEN" and c.laddr.port == port}
    times = psutil.Process(own).cpu_times()
    return float(times.user + times.system)


def taken_by(port: int, document: dict[str, Any]) -> float:
    """Seconds of the processor for an upload of one client."""
    began, end = processor(port), time.monotonic() + SECONDS
    done = len(Client(port, 0, document).upload_until(end))
    return (processor(port) - began) / done


def alone(folder: str, peer: int, document: dict[str, Any]) -> Iterator[Figure]:
    """What uploads take where nothing is made beside them, and how clients and services share the cores."""
    with services(folder, 1, beside=False) as ports:
        taken_by(ports[0], document)
        ours, theirs = in_turn(lambda: taken_by(ports[0], document), lambda: taken_by(peer, document))
        yield Figure("P5, processor", WORK.format(clients="processor of the service"), PEER, ours, theirs, "0.2")
        eight, two = in_turn(lambda: rate(ports, 8, document), lambda: rate(ports, 2, document))
        yield Figure("P5, clients", WORK.format(clients="8 clients"), "2 clients", 1 / eight, 1 / two, "≥ 1")
        with services(folder, 2, beside=False) as more:
            both, one = in_turn(lambda: rate(more, 8, document), lambda: rate(ports, 8, document))
        what = WORK.format(clients="8 clients, two services")
        yield Figure("P5, services", what, "one service", 1 / both, 1 / one, "≥ 1.7")


def run() -> Iterator[Figure]:
    """Upload rates of one service and of two, and how soon a diagnosis is there."""
    document = json.loads(session_bytes())
    with tempfile.TemporaryDirectory(prefix="imu-p5-", ignore_cleanup_errors=True) as folder, bare(folder) as peer:
        with services(folder, 1) as ports:
            taken = delays(ports[0], document)
            yield Figure(
                "P5, diagnosis", "from an upload's answer to its diagnosis, 95 of 100", "2 s",
                taken[int(0.95 * len(taken))], 2.0, "≥ 1",
            )  # fmt: skip
        for how_many, clients in ((1, 1), (1, 2), (1, 8), (2, 8)):
            with services(folder, how_many) as ports:
                ours, theirs = in_turn(
                    partial(rate, ports, clients, document), partial(rate, (peer,), clients, document)
                )
            name = f"{clients} client{'s' if clients > 1 else ''}{', two services' if how_many == 2 else ''}"
            yield Figure(f"P5, {name}", WORK.format(clients=name), PEER, 1 / ours, 1 / theirs, "0.2")
        yield from alone(folder, peer, document)


def main() -> None:
    """Prints the table."""
    print("| what | ours | peer | ratio | target |\n| --- | --- | --- | --- | --- |")
    for f in run():
        print(
            f"| {f.work} | {1e3 * f.ours:.3g} ms | {1e3 * f.theirs:.3g} ms | {f.ratio:.3g} | {f.target} |", flush=True
        )


if __name__ == "__main__":
    main()
