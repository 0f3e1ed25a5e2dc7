"""P7: pages and reports of a fleet of 10,000 units in PostgreSQL, against the same statements bare through psycopg.

Times are the processor's: of the service and of the database's processes together. Each page is asked in this process,
without a network between. The peer sends what the page sent, word for word, and reads every row. What a page costs
with ten times the units stands beside it.
"""

import asyncio
import sys
import tempfile
from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import httpx
import psycopg
from fastapi import FastAPI
from sqlalchemy import Engine, event

from benchmarks.figures import Figure
from benchmarks.fleet.cost import cost
from benchmarks.fleet.fill import NOW, TEMPLATES, Size, fill, multiply
from service.app import create_app
from service.fleet.changes import summarise_all
from service.opening import open_database
from service.settings import Settings
from service.storage import Files, Storage
from tests.databases import postgres_databases

SESSIONS = 20
"""Of every unit: a fifth of what P7 asks for, so that the fleet is filled in minutes and fits beside other work."""
FEW, MANY = 1_000, 10_000
UNIT = "BA-003-00007"
PAGES = {
    "fleet page": "/", "its tenth page": "/?page=10", "flags": "/flags", "stands": "/stands",
    "one stand": "/stands/ODG-1", "one unit": f"/units/{UNIT}", "sessions": "/sessions", "types": "/unit-types",
    "outlook": f"/api/v1/units/{UNIT}/outlook", "history": f"/api/v1/units/{UNIT}/history",
    "due dates": "/api/v1/feeds/due.ics", "condition": "/api/v1/fleet", "units as JSON": "/api/v1/units?limit=100",
    "report as JSON, 1,000 units": "/api/v1/fleet/report?limit=1000",
    "report as PDF": "/api/v1/fleet/report?format=pdf", "report as XLSX": "/api/v1/fleet/report?format=xlsx",
}  # fmt: skip
ROUNDS, SLOW = 5, ("report as PDF", "report as XLSX")
"""Times that each is asked; of those that take seconds once."""
NOTE = """
P7 is measured with 20 sessions a unit instead of a hundred, because a fleet of 10,000 units with all rows of a hundred
is 22 GB; no page of the fleet reads older sessions, and a unit's own are read by an index. Nothing is worked out over
the fleet in a request, and lists have 50 to 100 entries whatever the fleet. Its first target is missed everywhere,
because the peer makes nothing of what it reads: of the processor's time that the service itself takes, a request costs
four milliseconds before its page, by profile one for HTTP and what every request passes, and three for its threads, the
transaction and one statement; making 480 points of a history takes 10, a page of 285 kB with 480 points and their
charts 25, a calendar of a thousand events 20, and 40 charts of the paper a second. The database's own time is the same
in both, and on the first page of units, of one stand and of sessions it is half of all. What grows with the fleet is
the first page of units, by some milliseconds in which PostgreSQL sorts the units of one condition, and the workbook by
its sheet of all units.
"""


@dataclass(frozen=True)
class Fleet:
    """A filled database."""

    url: str
    server: int
    """The process that started the database's others."""


def run() -> Iterator[Figure]:
    """Every page of both fleets."""
    with filled() as (few, many):
        yield from compared(few, many)


@contextmanager
def filled() -> Iterator[tuple[Fleet, Fleet]]:
    """A fleet of a thousand units, and one of ten thousand of the same templates."""
    with postgres_databases() as databases, tempfile.TemporaryDirectory(prefix="imu-p7-") as folder:
        server = int((databases.server.pgdata / "postmaster.pid").read_text().split()[0])
        template = Storage(open_database(databases.migrated()), Files(Path(folder)))
        fill(template, Size(TEMPLATES, SESSIONS))
        template.database.close()
        fleets = []
        for units in (FEW, MANY):
            storage = Storage(open_database(databases.copied(template.database.url)), Files(Path(folder)))
            multiply(storage, units // TEMPLATES)
            summarise_all(storage, NOW)
            storage.database.close()
            fleets.append(Fleet(storage.database.url, server))
        yield fleets[0], fleets[1]


def compared(few: Fleet, many: Fleet) -> Iterator[Figure]:
    """The many against their bare statements, and against the few, page after page."""
    with opened(few) as small, opened(many) as large:
        for name, path in PAGES.items():
            before, now = small.cost(name, path), large.cost(name, path)
            work = f"{name}, 10,000 units × {SESSIONS} sessions, statements: {now.queries}"
            yield Figure(f"P7, {name}", work, "its statements through psycopg", now.ours, now.bare, "≥ 0.5")
            yield Figure(f"P7, {name}, flat", work, "the same with 1,000 units", now.ours, before.ours, "≥ 0.9")


@dataclass(frozen=True)
class PageCost:
    """Processor seconds of a page, and of its bare statements."""

    ours: float
    bare: float
    queries: int


@dataclass(frozen=True)
class Opened:
    """A fleet that is asked for pages."""

    asking: "Asking"
    bare: psycopg.Connection[Any]
    server: int

    def cost(self, name: str, path: str) -> PageCost:
        """Of one page."""
        rounds, asked = 1 if name in SLOW else ROUNDS, self.asking.statements(path)
        ours = cost(partial(self.asking.size_of, path), self.asking.engine, self.server, rounds)
        bare = cost(partial(read_bare, self.bare, asked), self.asking.engine, self.server, rounds)
        return PageCost(ours.seconds, bare.seconds, len(asked))


@contextmanager
def opened(fleet: Fleet) -> Iterator[Opened]:
    """The service on a fleet, and a connection beside it."""
    settings = Settings(
        database_url=fleet.url, data_folder=Path(tempfile.gettempdir()), diagnosis_workers=1, sign_in="off"
    )
    with psycopg.connect(fleet.url) as bare, closing(Asking(create_app(settings, clock=lambda: NOW))) as asking:
        yield Opened(asking, bare, fleet.server)


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

    def statements(self, path: str) -> list[tuple[str, Any]]:
        """What a page asks the database."""
        found: list[tuple[str, Any]] = []

        def note(_c: object, _k: object, statement: str, parameters: Any, *_: object) -> None:
            found.append((statement, parameters))

        event.listen(self.engine, "before_cursor_execute", note)
        self.size_of(path)
        event.remove(self.engine, "before_cursor_execute", note)
        return found


def read_bare(connection: psycopg.Connection[Any], asked: list[tuple[str, Any]]) -> int:
    """Rows of the same answer."""
    return sum(len(connection.execute(statement, parameters).fetchall()) for statement, parameters in asked)


def main() -> None:
    """Prints the table; of two databases that were filled before, where their addresses are given."""
    found = run()
    if len(sys.argv) == 3:
        folder = Path(str(psycopg.conninfo.conninfo_to_dict(sys.argv[1])["host"]))
        server = int((folder / "postmaster.pid").read_text().split()[0])
        found = compared(Fleet(sys.argv[1], server), Fleet(sys.argv[2], server))
    for f in found:
        print(f.row(), flush=True)


if __name__ == "__main__":
    main()
