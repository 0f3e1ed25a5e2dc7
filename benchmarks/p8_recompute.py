"""P8 and U5: stored sessions computed again under a new model by processes of this machine, against one process.

A few units come in by the front door; their sessions are multiplied under serial numbers and files of their own, in
PostgreSQL, until there are as many as were asked for. Then a cause is accepted for their type, and all of it is
computed again: a fifth of it, two thousand at most, by one process, the rest by as many as there are cores. Rates are
by the clock: a machine that does something else shows less than its own. Processor seconds a session are told beside
them, of these processes and of the database's: what they rise by is what working together costs.

    python -m benchmarks.p8_recompute --sessions 100000
"""

import argparse
import os
import tempfile
import time
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import psutil
from sqlalchemy import text

from benchmarks.figures import Felt, Figure
from benchmarks.fleet.cost import of_database
from benchmarks.fleet.many_files import NOW, SESSIONS, TYPE, fill
from service.opening import open_storage
from service.records.many import by_workers, units_behind
from service.settings import Settings
from service.storage import Storage
from tests.databases import PostgresDatabases, postgres_databases

ORDINARY = 2_000
"""Sessions in the table of all benchmarks: some minutes."""
ALONE = 2_000
"""Sessions for one process at most; a fifth of fewer."""

NOTE = """
P8 is by the clock. It recomputes 2,000 sessions here; `python -m benchmarks.p8_recompute --sessions 100000` as many as
its target names, [in 45 minutes on two cores](../docs/how-to/large-fleets.md#computing-a-fleet-again): each unit is a
transaction of its own, so that the time of a session does not grow with their number.
"""


@dataclass(frozen=True)
class Rate:
    """Rate of recomputation with so many processes."""

    workers: int
    sessions: int
    seconds: float
    """Seconds by the clock, without the start of the processes."""
    processor: float
    """Seconds of the processor, the database's among them."""

    @property
    def each(self) -> float:
        """Seconds by the clock for a session."""
        return self.seconds / self.sessions


def run(sessions: int = ORDINARY) -> Iterator[Figure | Felt]:
    """One process, then one for each core."""
    one, many = measured(sessions)
    cores = many.workers
    work = f"recompute {many.sessions:,} of {sessions:,} stored sessions by {cores} processes"
    yield Felt("U5", f"{work}: one session", many.each, 0.25)
    yield Figure("P8", work, f"one process, shared by {cores}", many.each, one.each / cores, "0.8")


def measured(sessions: int) -> tuple[Rate, Rate]:
    """The rates of one process and of as many as cores."""
    cores = os.cpu_count() or 1
    with postgres_databases() as databases, tempfile.TemporaryDirectory(prefix="imu-p8-") as folder:
        settings = Settings(database_url=databases.migrated(), data_folder=Path(folder))
        storage = open_storage(settings)
        with closing(storage.database):
            fill(storage, sessions // SESSIONS)
            accept(storage)
            first = max(min(ALONE, sessions // 5) // SESSIONS, 1)
            server = server_of(databases)
            return rate(storage, settings, server, 1, first), rate(storage, settings, server, cores, None)


def server_of(databases: PostgresDatabases) -> int:
    """The process that started the database's others."""
    return int((databases.server.pgdata / "postmaster.pid").read_text().split()[0])


def accept(storage: Storage) -> None:
    """A cause that every session is computed again for."""
    with storage.database.engine.begin() as connection:
        connection.execute(
            text(
                "INSERT INTO model_revisions (scope, subject, cause, sensors, session_id, evidence, accepted_by, note,"
                " accepted_at) SELECT 'unit type', :type, 'cubic-nonlinearity', '[\"A1\"]', min(id), 'null', 'P8', '',"
                " :at FROM sessions"
            ),
            {"type": TYPE, "at": NOW},
        )


def rate(storage: Storage, settings: Settings, server: int, workers: int, units: int | None) -> Rate:
    """The rate of so many processes at the next units, or at all that are left."""
    with by_workers(storage, settings, lambda: NOW, workers=workers) as run:
        began, spent = time.monotonic(), processor(server)
        done = [one.done for one in run(islice(units_behind(storage), units))]
        seconds, spent = time.monotonic() - began, processor(server) - spent
    assert None not in done
    return Rate(workers, sum(one.recomputed for one in done if one is not None), seconds, spent)


def processor(server: int) -> float:
    """Seconds of this process, of those that it started and of the database's."""
    children = psutil.Process().children(recursive=True)
    own = (child.cpu_times() for child in children if child.status() != psutil.STATUS_ZOMBIE)
    return time.process_time() + sum(t.user + t.system for t in own) + of_database(server)


def main() -> None:
    """Prints both rates and what they come to."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--sessions", type=int, default=ORDINARY)
    one, many = measured(parser.parse_args().sessions)
    print("| processes | sessions | seconds | sessions a second | processor, ms a session |")
    print("| --- | --- | --- | --- | --- |")
    for r in (one, many):
        told = f"{r.seconds:.0f} | {1 / r.each:.1f} | {1e3 * r.processor / r.sessions:.0f}"
        print(f"| {r.workers} | {r.sessions:,} | {told} |")
    print(f"share of linear with cores: {one.each / many.each / many.workers:.2f} (target 0.8)")


if __name__ == "__main__":
    main()
