"""Tests whether partitions of the largest table would pay: ``python -m benchmarks.fleet.partitions``.

The parameters of a filled fleet are copied into three tables with the same rows, keys and indexes: one as it is, one in
sixteen parts by unit, one in parts by year. What is done with them is timed by the clock, warm, medians in turn over
the three; the oldest year is taken out last. Writes a section of benchmarks/results/how-to/large-fleets.md; with the
address of a filled database it takes that one, and leaves it as it was.
"""

import statistics
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from itertools import cycle, islice
from pathlib import Path

import psycopg

from benchmarks.details import RESULTS
from benchmarks.fleet.fill import Size, fill
from benchmarks.sections import write_section
from service.opening import open_database
from service.storage import Files, Storage
from tests.databases import postgres_databases

PAGE = RESULTS / "how-to" / "large-fleets.md"
MARK = "<!-- written by python -m benchmarks.fleet.partitions -->"
SIZE = Size(5_000, 20)
PARTS, YEARS = 16, range(2020, 2027)
LAYOUTS = {"one table": "", "by unit": "PARTITION BY HASH (unit_id)", "by year": "PARTITION BY RANGE (at)"}
KEYS = {"one table": "", "by unit": ", unit_id", "by year": ", at"}
"""Columns that the primary key must hold besides its own, by layout."""
KEY = "session_id, revision, sensor, parameter"
HISTORY = "SELECT * FROM {0} WHERE unit_id = %s ORDER BY at, session_id, sensor_index, parameter"
SESSION = "SELECT * FROM {0} WHERE session_id = %s AND revision = 0"
INSERT = (
    "INSERT INTO {0} (session_id, revision, sensor, parameter, unit_id, at, sensor_index, kind, value, u)"
    " SELECT %s, revision, sensor, parameter, unit_id, at + interval '1 hour', sensor_index, kind, value, u"
    " FROM parameters WHERE session_id = %s AND revision = 0"
)
FIRST_YEAR = "2022-01-01"
"""Rows measured before this date are taken out."""
TIMES = 200

Connection = psycopg.Connection[tuple[object, ...]]


def main() -> None:
    """Writes the section."""
    if len(sys.argv) > 1:
        lines = written(sys.argv[1])
    else:
        with postgres_databases() as databases, tempfile.TemporaryDirectory(prefix="imu-parts-") as folder:
            storage = Storage(open_database(databases.migrated()), Files(Path(folder)))
            fill(storage, SIZE)
            storage.database.close()
            lines = written(storage.database.url)
    write_section(PAGE, MARK, lines)
    print(lines)


def written(url: str) -> str:
    """The table, from a filled database."""
    with psycopg.connect(url.replace("+psycopg", ""), autocommit=True) as connection:
        tables = {layout: f"parts_{number}" for number, layout in enumerate(LAYOUTS)}
        try:
            for layout, table in tables.items():
                copy(connection, layout, table)
            return "\n".join(lines(connection, tables))
        finally:
            for table in tables.values():
                connection.execute(f"DROP TABLE IF EXISTS {table}")


def copy(connection: Connection, layout: str, table: str) -> None:
    """Copies the rows into another layout."""
    connection.execute(f"CREATE TABLE {table} (LIKE parameters) {LAYOUTS[layout]}")
    if layout == "by unit":
        for k in range(PARTS):
            own = f"FOR VALUES WITH (MODULUS {PARTS}, REMAINDER {k})"
            connection.execute(f"CREATE TABLE {table}_{k} PARTITION OF {table} {own}")
    if layout == "by year":
        for year in YEARS:
            own = f"FOR VALUES FROM ('{year}-01-01') TO ('{year + 1}-01-01')"
            connection.execute(f"CREATE TABLE {table}_{year} PARTITION OF {table} {own}")
    connection.execute(f"INSERT INTO {table} SELECT * FROM parameters")
    connection.execute(f"ALTER TABLE {table} ADD PRIMARY KEY ({KEY}{KEYS[layout]})")
    connection.execute(f"CREATE INDEX ON {table} (unit_id, at, session_id, sensor_index, parameter)")
    connection.execute(f"VACUUM ANALYZE {table}")


def lines(connection: Connection, tables: dict[str, str]) -> Iterator[str]:
    """One line for each thing that is done."""
    rows = connection.execute("SELECT count(*) FROM parameters").fetchone()
    units = [row[0] for row in connection.execute("SELECT id FROM units ORDER BY md5(serial) LIMIT 200")]
    sessions = [row[0] for row in connection.execute("SELECT id FROM sessions ORDER BY id LIMIT 200")]
    assert rows is not None

    def insert(table: str, k: int) -> None:
        connection.execute(INSERT.format(table), (f"new-{k}", sessions[k]))

    def read(query: str, keys: list[object]) -> Callable[[str, int], object]:
        return lambda table, k: connection.execute(query.format(table), (keys[k],)).fetchall()

    yield f"| {rows[0]:,} rows, ms | {' | '.join(tables)} |"
    yield f"| --- |{' --- |' * len(tables)}"
    for name, work in (
        ("the history of a unit", read(HISTORY, units)),
        ("the rows of a session, by its key", read(SESSION, sessions)),
        ("a session's rows are added", insert),
    ):
        yield line(name, [f"{1e3 * one:.2f}" for one in in_turn(work, tables)])
    yield line("all are vacuumed", [f"{1e3 * once(connection, f'VACUUM {table}'):,.0f}" for table in tables.values()])
    yield line(f"all before {FIRST_YEAR} are taken out", [f"{1e3 * one:,.0f}" for one in taken_out(connection, tables)])


def line(name: str, cells: list[str]) -> str:
    """A line of the table."""
    return f"| {name} | {' | '.join(cells)} |"


def in_turn(work: Callable[[str, int], None], tables: dict[str, str]) -> list[float]:
    """Median seconds for each table, in turn and each as often first, so that what is cold meets all alike; the first
    rounds are warm-up."""
    taken: dict[str, list[float]] = {table: [] for table in tables.values()}
    for k in range(TIMES):
        for table in islice(cycle(taken), k, k + len(taken)):
            began = time.perf_counter()
            work(table, k)
            taken[table].append(time.perf_counter() - began)
    return [statistics.median(own[TIMES // 10 :]) for own in taken.values()]


def once(connection: Connection, statement: str) -> float:
    """Seconds of one statement."""
    began = time.perf_counter()
    connection.execute(statement)
    return time.perf_counter() - began


def taken_out(connection: Connection, tables: dict[str, str]) -> Iterator[float]:
    """Seconds of taking out old rows: by deleting and vacuuming, or by dropping the parts of those years."""
    for layout, table in tables.items():
        if layout == "by year":
            old = ", ".join(f"{table}_{year}" for year in YEARS if f"{year + 1}-01-01" <= FIRST_YEAR)
            yield once(connection, f"DROP TABLE {old}")
        else:
            deleted = once(connection, f"DELETE FROM {table} WHERE at < '{FIRST_YEAR}'")
            yield deleted + once(connection, f"VACUUM {table}")


if __name__ == "__main__":
    main()
