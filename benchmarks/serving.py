"""Serving under load: how long clients wait for an upload, against the bare endpoint of P5, and readers for a page.

Eight clients upload without pause; beside them one reads the fleet page, once the same page without anybody else, when
some units are stored and diagnosed. Times are by the clock. The service runs as it comes: one process, its diagnoses in
processes beside it, SQLite.
"""

import json
import tempfile
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from http.client import HTTPConnection

from benchmarks.figures import Figure
from benchmarks.p5_uploads import PEER, Client, bare, delays, services
from tests.service.made_sessions import session_bytes

CLIENTS = 8
SECONDS = 15.0
"""That each load lasts."""
SHARES = {"p50": 0.5, "p95": 0.95, "p99": 0.99}

NOTE = """
Serving: a request waits for the others' work on the one interpreter of a service, so that eight clients wait eight
times as long as one, and the unluckiest twice as long as the middle. A page is read between their transactions, and
waits for none of them. Requests are worked on by threads, at most forty at once; each holds one of fifteen connections
of PostgreSQL's pool while it asks. More clients are served by more services on one database, on cores of their own.
"""


def run() -> Iterator[Figure]:
    """Uploads of both, then the page."""
    document = json.loads(session_bytes())
    with tempfile.TemporaryDirectory(prefix="imu-serving-", ignore_cleanup_errors=True) as folder:
        with bare(folder) as peer:
            theirs, _ = under_load(peer, document, lambda _port, _end: [])
        with services(folder, 1) as (port,):
            delays(port, document)
            alone = read_until(port, time.monotonic() + SECONDS / 3)
            ours, beside = under_load(port, document, read_until)
    for name, share in SHARES.items():
        work = f"an upload of one of {CLIENTS} clients, {name}, by the clock"
        yield Figure(f"serving, uploads, {name}", work, PEER, at(ours, share), at(theirs, share), "—")
    for name, share in SHARES.items():
        work = f"the fleet page beside {CLIENTS} uploading clients, {name}, by the clock"
        yield Figure(f"serving, page, {name}", work, "the same alone", at(beside, share), at(alone, share), "—")


def under_load(
    port: int, document: dict[str, object], read: Callable[[int, float], list[float]]
) -> tuple[list[float], list[float]]:
    """Seconds of every upload, and of what is read beside."""
    end = time.monotonic() + SECONDS
    with ThreadPoolExecutor(CLIENTS + 1) as pool:
        reading = pool.submit(read, port, end)
        jobs = [pool.submit(Client(port, number, document).upload_until, end) for number in range(CLIENTS)]
        return [one for job in jobs for one in job.result()], reading.result()


def read_until(port: int, end: float) -> list[float]:
    """Seconds of every look at the fleet page."""
    connection, taken = HTTPConnection("127.0.0.1", port, timeout=120), []
    while time.monotonic() < end:
        began = time.monotonic()
        connection.request("GET", "/", headers={"Accept": "text/html"})
        connection.getresponse().read()
        taken.append(time.monotonic() - began)
    connection.close()
    return taken


def at(taken: list[float], share: float) -> float:
    """The quantile."""
    return sorted(taken)[int(share * len(taken))]
