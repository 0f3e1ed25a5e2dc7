"""Bytes of a stored session: ``python -m benchmarks.fleet.bytes``.

A few units come in by the front door with their diagnoses; then every table is counted as PostgreSQL keeps it, with its
indexes and what it puts aside of long values, over the sessions. A table that grows with units says so by its rows.
"""

import tempfile
from contextlib import closing
from pathlib import Path

from sqlalchemy import Connection, text

from benchmarks.fleet.fill import NOW, Size, fill
from service.opening import open_storage
from service.records.diagnose import diagnose
from service.settings import Settings
from service.storage import Storage
from tests.databases import postgres_databases

SIZE = Size(units=10, sessions=8)
LEAST = 50
"""Bytes a session below which a table is not told by itself."""
SIZES = (
    "SELECT relname, n_live_tup, pg_total_relation_size(relid), pg_indexes_size(relid) FROM pg_stat_user_tables"
    " ORDER BY 3 DESC"
)


def tables(connection: Connection) -> list[tuple[str, int, int, int]]:
    """Name, rows, bytes with indexes, bytes of indexes."""
    connection.execute(text("VACUUM FULL"))
    connection.execute(text("ANALYZE"))
    return [tuple(row) for row in connection.execute(text(SIZES))]


def diagnose_all(storage: Storage) -> None:
    """Every session, as the service does beside the requests."""
    with storage.database.engine.connect() as connection:
        ids = list(connection.scalars(text("SELECT id FROM sessions ORDER BY started_at")))
    for id in ids:
        diagnose(storage, id, NOW)


def main() -> None:
    """Prints the table."""
    sessions = SIZE.units * SIZE.sessions
    with postgres_databases() as databases, tempfile.TemporaryDirectory(prefix="imu-bytes-") as folder:
        storage = open_storage(Settings(database_url=databases.migrated(), data_folder=Path(folder)))
        with closing(storage.database):
            engine = storage.database.engine.execution_options(isolation_level="AUTOCOMMIT")
            with engine.connect() as connection:
                empty = {name: size for name, _, size, _ in tables(connection)}
            fill(storage, SIZE)
            diagnose_all(storage)
            with engine.connect() as connection:
                found = tables(connection)
        files = sum(path.stat().st_size for path in storage.files.folder.rglob("*") if path.is_file())
    report([(name, rows, size - empty[name], indexes) for name, rows, size, indexes in found], files, sessions)


def report(found: list[tuple[str, int, int, int]], files: int, sessions: int) -> None:
    """A line of every table that counts, the rest in one, and the files."""
    print("| table | rows a session | bytes a session | of these indexes |\n| --- | --- | --- | --- |")
    large = [one for one in found if one[2] / sessions >= LEAST]
    for name, rows, size, indexes in large:
        print(f"| `{name}` | {rows / sessions:.3g} | {size / sessions:,.0f} | {indexes / sessions:,.0f} |")
    rest = sum(size for _, _, size, _ in found) - sum(size for _, _, size, _ in large)
    print(f"| all others | | {rest / sessions:,.0f} | |")
    print(f"| **database** | | {sum(size for _, _, size, _ in found) / sessions:,.0f} | |")
    print(f"| **files** | 1 | {files / sessions:,.0f} | |")


if __name__ == "__main__":
    main()
