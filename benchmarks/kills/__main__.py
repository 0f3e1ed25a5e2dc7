"""Kills the service with `kill -9` at random moments while clients upload, and on PostgreSQL the database in turn with
it; then says what was lost, and writes it into docs/security/durability.md."""

import argparse
import os
import random
import re
import signal
import sys
import tempfile
import time
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path

import psycopg

from benchmarks.kills.load import Load
from benchmarks.kills.server import Service, free_port
from service.settings import Settings
from tests.databases import Databases, postgres_databases, sqlite_databases
from tests.service.storage.intact import faults

PAGE = Path(__file__).parents[2] / "docs" / "security" / "durability.md"
LONGEST = 5.0
"""Seconds from one start to the next kill at most: an upload takes some tenths of it on a machine that is not busy."""
ATTEMPTS, PAUSE = 600, 0.1
"""To reach a database that recovers, and the seconds between them."""
ENGINES: dict[str, Callable[[], AbstractContextManager[Databases]]] = {
    "sqlite": sqlite_databases,
    "postgresql": postgres_databases,
}


@dataclass(frozen=True)
class Seen:
    """What the kills left."""

    engine: str
    service_kills: int
    database_kills: int
    load: Load
    faults: list[str]

    def row(self) -> str:
        """A line of the table."""
        kinds = [sum(f.startswith(kind) for f in self.faults) for kind in ("lost", "twice")]
        halves = len(self.faults) - sum(kinds)
        numbers = [self.service_kills, self.database_kills, len(self.load.sent), len(self.load.acknowledged)]
        cells = [*numbers, self.load.repeated, *kinds, halves, len(self.load.refused)]
        return f"| {self.engine} | " + " | ".join(f"{cell:,}" for cell in cells) + " |"


def main() -> int:
    """Exit code 1 where anything was lost."""
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("--kills", type=int, default=100)
    asked.add_argument("--engine", choices=ENGINES, default="sqlite")
    asked.add_argument("--seed", type=int, default=1)
    asked.add_argument("--page", type=Path, default=PAGE)
    given = asked.parse_args()
    with ENGINES[given.engine]() as databases, tempfile.TemporaryDirectory(prefix="imu-kills-") as folder:
        settings = Settings(database_url=databases.migrated(), data_folder=Path(folder))
        seen = killed(given.engine, settings, given.kills, given.seed)
    print(seen.row())
    print("\n".join([*seen.faults, *seen.load.refused][:20]), file=sys.stderr)
    text = given.page.read_text("utf-8")
    given.page.write_text(re.sub(rf"^\| {given.engine} \|.*$", seen.row(), text, flags=re.MULTILINE), "utf-8")
    return bool(seen.faults or seen.load.refused)


def killed(engine: str, settings: Settings, kills: int, seed: int) -> Seen:
    """Runs the load through so many kills; on PostgreSQL every second one is the database's."""
    service, chance = Service(settings, free_port()), random.Random(seed)
    load, database_kills = Load(service.address, seed), 0
    service.start()
    with load.running():
        for number in range(kills):
            time.sleep(chance.uniform(0.0, LONGEST))
            if engine == "postgresql" and number % 2:
                _kill_database(settings)
                database_kills += 1
            else:
                service.kill()
                service.start()
    service.kill()
    service.start()
    found = faults(settings, load.acknowledged, load.sent)
    service.kill()
    return Seen(engine, kills - database_kills, database_kills, load, found)


def _kill_database(settings: Settings) -> None:
    """`kill -9` of one of its processes: all others are ended too, and it recovers from its log."""
    for _ in range(ATTEMPTS):
        try:
            with psycopg.connect(settings.database) as connection:
                os.kill(connection.info.backend_pid, signal.SIGKILL)
                connection.execute("SELECT 1")
        except psycopg.OperationalError as fault:
            if "recovery" not in str(fault) and "starting" not in str(fault):
                return
            time.sleep(PAUSE)
    raise TimeoutError("the database did not come back")


if __name__ == "__main__":
    sys.exit(main())
