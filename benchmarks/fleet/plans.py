"""Writes PostgreSQL's plans for the queries of a large fleet's pages, as a file of benchmarks/results.

``python -m benchmarks.fleet.plans`` fills a fleet of 10,000 units and writes them; with the address of a
database that was filled so, it reads that one.
"""

import re
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

from sqlalchemy import event, text

from benchmarks.details import RESULTS
from benchmarks.fleet.fill import NOW, Size, fill
from service.flags.store import FlagQuery, Flags
from service.fleet.changes import summarise_all
from service.fleet.records import FleetQuery, Order
from service.fleet.store import Fleet
from service.opening import open_database
from service.outlook.store import Outlooks, Populations
from service.sessions.history_store import History, HistoryQuery
from service.sessions.records import SessionQuery
from service.sessions.store import Sessions
from service.stands.store import Stands
from service.storage import Files, Storage
from service.storage.queries import Store
from service.units.store import Units
from tests.databases import postgres_databases

PAGE = RESULTS / "how-to" / "plans.md"
HEAD = """# What PostgreSQL reads for the pages of a large fleet

Written by `python -m benchmarks.fleet.plans`: `EXPLAIN` for 10,000 units with 20 sessions each; small tables are read
whole.
"""
SIZE = Size(10_000, 20)
UNIT, STAND = "BA-003-00007", "ODG-1"
QUESTIONS: dict[str, Callable[[Store], object]] = {
    "The counts of the fleet page": lambda store: Fleet(store).condition(),
    "A page of units, worst first": lambda store: Fleet(store).units(FleetQuery(limit=51)),
    "The next page, after a unit": lambda store: Fleet(store).units(FleetQuery(limit=51, after=UNIT)),
    "Units last measured on a stand": lambda store: Fleet(store).units(
        FleetQuery(stand=STAND, order=Order.LAST, backwards=True, limit=26)
    ),
    "Who drifts unlike the others": lambda store: Populations(store).furthest(6),
    "Due dates": lambda store: Outlooks(store).due(1000),
    "How stands are used": lambda store: Stands(store).every(),
    "Open flags": lambda store: Flags(store).page(FlagQuery(unresolved=True, limit=101)),
    "Sessions, the newest first": lambda store: Sessions(store).wanted(SessionQuery(limit=51)),
    "The history of a unit": lambda store: History(store).points(Units(store).key(UNIT), HistoryQuery()),
    "What the page of a unit begins with": lambda store: Fleet(store).unit_known(UNIT, NOW),
}
NODE = re.compile(r"(Seq Scan|Index Only Scan|Index Scan|Bitmap Index Scan)( Backward)?( using (\w+))?( on (\w+))?")
"""Nodes of a plan that read rows."""


def main() -> None:
    """Writes the section."""
    if len(sys.argv) > 1:
        lines = _written(Storage(open_database(sys.argv[1]), Files(Path(tempfile.gettempdir()))))
    else:
        with postgres_databases() as databases, tempfile.TemporaryDirectory(prefix="imu-plans-") as folder:
            storage = Storage(open_database(databases.migrated()), Files(Path(folder)))
            fill(storage, SIZE)
            lines = _written(storage)
    PAGE.write_text(f"{HEAD}\n{lines}\n", encoding="utf-8")


def _written(storage: Storage) -> str:
    summarise_all(storage, NOW)
    lines = "\n".join(_lines(storage))
    storage.database.close()
    return lines


def _lines(storage: Storage) -> Iterator[str]:
    yield "| what is asked | what PostgreSQL reads |"
    yield "| --- | --- |"
    for name, question in QUESTIONS.items():
        yield f"| {name} | {'; '.join(dict.fromkeys(_reads(storage, question)))} |"


def _reads(storage: Storage, question: Callable[[Store], object]) -> Iterator[str]:
    """The tables and indexes of every statement of a question, as EXPLAIN names them."""
    asked: list[tuple[str, object]] = []

    def note(_c: object, _k: object, statement: str, parameters: object, *_: object) -> None:
        asked.append((statement, parameters))

    engine = storage.database.engine
    event.listen(engine, "before_cursor_execute", note)
    with storage.database.reading() as store:
        question(store)
    event.remove(engine, "before_cursor_execute", note)
    with engine.connect() as connection:
        for statement, parameters in asked:
            rows = connection.exec_driver_sql(f"EXPLAIN {statement}", parameters)
            yield from (_read(match) for (line,) in rows for match in NODE.finditer(line))
        connection.execute(text("ROLLBACK"))


def _read(node: re.Match[str]) -> str:
    """``sessions by pk_sessions``; without an index the whole of a table."""
    table, index = node[6], node[4]
    if node[1] == "Bitmap Index Scan":
        return f"`{table}`"
    return f"`{table}` by `{index}`" if index else f"all of `{table}`"


if __name__ == "__main__":
    main()
