"""U4: pages of a fleet of 10,000 units in PostgreSQL, and of a unit with 500 sessions among them; U10 with them.

What the service takes for a page is the processor's time, of the service and of the database's processes together,
without a network between. When the first words stand there is by the clock, in a real Chromium that has kept nothing
from before, on this machine and as a phone far from the service would see it (1.6 Mbit/s, 150 ms there and back, a
processor four times slower).
"""

import asyncio
import shutil
import statistics
import tempfile
from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import httpx
from fastapi import FastAPI
from playwright.sync_api import Browser, sync_playwright
from sqlalchemy import Engine, text

from benchmarks.figures import Felt, children, importing
from benchmarks.fleet.cost import cost
from benchmarks.fleet.fill import NOW, STANDS, TEMPLATES, Size, fill, live, serial
from benchmarks.kills.server import Service, free_port
from service.app import create_app
from service.fleet.changes import summarise_all
from service.opening import open_database
from service.settings import Settings
from service.storage import Files, Storage
from tests.databases import postgres_databases
from tests.end_to_end.browser.conftest import FLAGS, NAMES

UNITS, SESSIONS, MANY = 10_000, 20, 500
"""Units of the fleet, sessions of each of its units, and sessions of one more unit."""
ROUNDS, LOOKS = 5, 3
"""Times that each page is asked for, and looked at."""
SERVER, PAINT = 0.5, 8.0
"""m."""
FAR = {"offline": False, "latency": 150, "downloadThroughput": 1.6e6 / 8, "uploadThroughput": 0.75e6 / 8}
"""ms, bytes a second: what Lighthouse takes for a slow connection by radio."""
SLOWER = 4
"""Times that a phone's processor is slower than this one."""
PAINTED = "performance.getEntriesByName('first-contentful-paint')"
"""Script for the first paint of a page; empty before it."""
SOON = 20.0
"""Milliseconds between two looks at whether it is there."""
SINCE = f"/api/v1/stands/{STANDS[0]}/resting-certificates?since=2025-06-01"
"""The question of U10: half a year on one of three stands."""
ISSUED = """
INSERT INTO certificates (number, session_id, revision, issued_at, who, content_hash)
SELECT 'C-' || id, id, 0, started_at, 'U10', '' FROM sessions
"""
"""A certificate of every session."""
NOTE = """
U4 misses its target for the fleet, whose page counts 10,000 units by condition, stand and type in eight statements, by
little for a unit with 500 sessions, and for the charts of one parameter, a request of their own that a unit's page
sends for what stands open; of 500 sessions they show the extremes. A plan for sensors on a cone is kept: asked for
the first time it takes some 2 m, as it simulates the session.
"""


@dataclass(frozen=True)
class Fleet:
    """A filled database."""

    settings: Settings
    server: int
    """The process that started the database's others."""
    pages: dict[str, str]
    """Pages by name."""


def run() -> Iterator[Felt]:
    """Measures the service's time for pages, then the time until they are seen."""
    with filled() as fleet:
        with closing(Asking(create_app(fleet.settings, clock=lambda: NOW))) as asking:
            yield from served(fleet, asking)
        service = Service(fleet.settings, free_port(), beside=False)
        service.start()
        try:
            yield from seen(service.address, fleet.pages)
        finally:
            service.kill()


@contextmanager
def filled() -> Iterator[Fleet]:
    """Ten thousand units of ten templates, and one with a long history."""
    with postgres_databases() as databases, tempfile.TemporaryDirectory(prefix="imu-u4-") as folder:
        server = int((databases.server.pgdata / "postmaster.pid").read_text().split()[0])
        storage = Storage(open_database(databases.migrated()), Files(Path(folder)))
        fill(storage, Size(UNITS, SESSIONS))
        summarise_all(storage, NOW)
        last = live(storage, TEMPLATES, MANY)
        with storage.database.engine.begin() as connection:
            connection.execute(text(ISSUED))
            connection.execute(text("ANALYZE"))  # as the database does by itself within minutes
        storage.database.close()
        pages = {
            "fleet": "/", "flags": "/flags", "stands": "/stands", "one stand": f"/stands/{STANDS[0]}",
            "sessions": "/sessions", f"unit, {MANY} sessions": f"/units/{serial(TEMPLATES)}",
            f"charts of a parameter, {MANY} sessions": f"/units/{serial(TEMPLATES)}/parameters/bias-accelerometer",
            "session": f"/sessions/{last}", "diagnosis": f"/sessions/{last}/diagnosis", "plan": "/plan",
        }  # fmt: skip
        settings = Settings(
            database_url=storage.database.url, data_folder=Path(folder), diagnosis_workers=1, sign_in="off"
        )
        yield Fleet(settings, server, pages)


def served(fleet: Fleet, asking: "Asking") -> Iterator[Felt]:
    """Processor seconds of every page, and of the list that a fault of a stand concerns."""
    reports = {f"report as {form.upper()}": f"/api/v1/fleet/report?format={form}" for form in ("pdf", "xlsx")}
    for name, path in (fleet.pages | reports).items():
        most = None if name in reports else SERVER
        taken = cost(partial(asking.size_of, path), asking.engine, fleet.server, ROUNDS if most else 1)
        work = f"{name}, of {UNITS:,} units, {taken.queries} statements, processor of service and database"
        yield Felt(f"U4, {name}", work, taken.seconds, most, m=importing(children))
    taken = cost(partial(asking.size_of, SINCE), asking.engine, fleet.server, ROUNDS)
    work = f"a stand found bad: certificates of half a year, of {UNITS:,} units ({taken.size / 1e6:.1f} MB)"
    yield Felt("U10", work, taken.seconds, 1.0, "s", m=importing(children))


class Asking:
    """Asks an application for pages within this process; its work beside the requests does not run."""

    def __init__(self, app: FastAPI) -> None:
        self.engine: Engine = app.state.application.storage.database.engine
        self._client = httpx.AsyncClient(transport=httpx.ASGITransport(app), base_url="http://127.0.0.1")
        self._runner = asyncio.Runner()

    def close(self) -> None:
        """Lets the database go."""
        self._runner.run(self._client.aclose())
        self._runner.close()
        self.engine.dispose()

    def size_of(self, path: str) -> int:
        """Bytes of an answer."""
        headers = {} if "/api/" in path else {"Accept": "text/html"}
        return len(self._runner.run(self._client.get(path, headers=headers)).raise_for_status().content)


def seen(address: str, pages: dict[str, str]) -> Iterator[Felt]:
    """Measures pages in a browser."""
    found = next(filter(None, map(shutil.which, NAMES)), None)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=found, args=list(FLAGS))
        for name, path in pages.items():
            looks = [first_paint(browser, address + path, is_far=False) for _ in range(LOOKS)]
            yield Felt(f"U4, {name}, paint", f"{name}, first words seen", statistics.median(looks), PAINT)
        for name in ("fleet", f"unit, {MANY} sessions"):
            look = first_paint(browser, address + pages[name], is_far=True)
            yield Felt(f"U4, {name}, far", f"{name}, first words seen on a phone far away", look, None)
        browser.close()


def first_paint(browser: Browser, url: str, *, is_far: bool) -> float:
    """Seconds, of a first visit."""
    with closing(browser.new_context(viewport={"width": 1280, "height": 900})) as context:
        page = context.new_page()
        wire = context.new_cdp_session(page)
        if is_far:
            wire.send("Network.enable")
            wire.send("Network.emulateNetworkConditions", FAR)
            wire.send("Emulation.setCPUThrottlingRate", {"rate": SLOWER})
        page.goto(url, timeout=120_000)
        while not page.evaluate(f"{PAINTED}.length"):  # a page forbids the waiting that evaluates within it
            page.wait_for_timeout(SOON)
        return float(page.evaluate(f"{PAINTED}[0].startTime")) / 1000
