"""P11: an upload to a unit with 500 sessions, on a stand with 5,000, against the tenth session of a unit.

Ten units with eight sessions each come in by the front door, on one stand, into PostgreSQL; their sessions are
multiplied within the database, hour by hour after the first, until every unit has 500. Times are the processor's, of
this process and of the database's together: from the file's bytes to the commit. What follows beside the requests is
left out.
"""

import json
import statistics
import tempfile
import time
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path

from sqlalchemy import inspect, text

from benchmarks.figures import Figure
from benchmarks.fleet.cost import of_database
from benchmarks.fleet.fill import KEY
from service.opening import open_database
from service.storage import Files, Storage
from service.storage.engine import open_engine
from service.storage.waits import PATIENT
from service.uploads.receive import upload
from tests.builders import accelerometer_block
from tests.databases import postgres_databases

UNITS, FIRST, SESSIONS = 10, 8, 500
"""Units on the stand, their sessions that come in by the front door, and all of each."""
ROUNDS = 15
START = datetime(2020, 1, 1, 9, tzinfo=UTC)
NOW = datetime(2026, 6, 1, 12, tzinfo=UTC)
COPIED = ("sessions", "parameters", "decisions", "common_motions")
CHANGED = {
    "sessions.id": KEY, "session_id": KEY, "sha256": "md5({0} || '/' || n) || md5(n || '/' || {0})",
    "content_digest": "md5({0} || '/' || n)", "started_at": "{0} + n * interval '1 hour'",
    "at": "{0} + n * interval '1 hour'", "is_reference": "false",
}  # fmt: skip
"""Expressions for the columns of a copy that differ from the original."""
NOTE = """
P11 reaches its target: what grows with a history is reading the unit's own sessions in short, one row each, and
counting them by stand.
"""


def run() -> Iterator[Figure]:
    """Measures both uploads, in turn."""
    with postgres_databases() as databases, tempfile.TemporaryDirectory(prefix="imu-p11-") as folder:
        storage = Storage(open_database(databases.migrated()), Files(Path(folder)))
        server = int((databases.server.pgdata / "postmaster.pid").read_text().split()[0])
        fill(storage)
        ours, theirs = uploads(storage, server)
        storage.database.close()
    work = f"upload to a unit with {SESSIONS} sessions, on a stand with {UNITS * SESSIONS:,}"
    yield Figure("P11", work, "the tenth session of a unit", ours, theirs, "≥ 0.67")


def fill(storage: Storage) -> None:
    """Ten units with 500 sessions each on one stand."""
    for unit in range(UNITS):
        for number in range(FIRST):
            upload(storage, content(f"OLD-{unit}", number, START + number * timedelta(days=200)), "a.json", NOW)
    patient = open_engine(storage.database.url, PATIENT)
    with patient.begin() as connection:
        for table in COPIED:
            columns = [column["name"] for column in inspect(connection).get_columns(table)]
            made = [CHANGED.get(f"{table}.{c}", CHANGED.get(c, c)).format(c) for c in columns]
            times = (SESSIONS - FIRST) // FIRST
            own = f"SELECT {', '.join(made)} FROM {table}, generate_series(1, {times}) AS n"
            connection.execute(text(f"INSERT INTO {table} ({', '.join(columns)}) {own}"))
    with patient.connect().execution_options(isolation_level="AUTOCOMMIT") as connection:
        connection.execute(text("VACUUM ANALYZE"))
    patient.dispose()


def content(unit: str, seed: int, at: datetime) -> bytes:
    """A session of a unit."""
    document = accelerometer_block(6, seed=seed, unit=unit, positions=24)
    return json.dumps(document | {"started_at": at.isoformat()}).encode()


def uploads(storage: Storage, server: int) -> tuple[float, float]:
    """Median seconds of an upload to a unit with a long history, and of the tenth of another."""
    taken: tuple[list[float], list[float]] = ([], [])
    for turn in range(ROUNDS):
        young = f"NEW-{turn}"
        for number in range(9):
            upload(storage, content(young, number, START + number * timedelta(days=200)), "a.json", NOW)
        for unit, times in ((f"OLD-{turn % UNITS}", taken[0]), (young, taken[1])):
            body = content(unit, 1000 + turn, NOW - timedelta(days=30 - turn))
            began = time.process_time() + of_database(server)
            upload(storage, body, "a.json", NOW)
            times.append(time.process_time() + of_database(server) - began)
    return statistics.median(taken[0]), statistics.median(taken[1])


def main() -> None:
    """Prints the figure."""
    for f in run():
        print(f"{f.work}: {1e3 * f.ours:.3g} ms, {f.peer}: {1e3 * f.theirs:.3g} ms, ratio {f.ratio:.3g}")


if __name__ == "__main__":
    main()
