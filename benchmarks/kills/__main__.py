"""Kills the service with `kill -9` at random moments while clients upload, and on PostgreSQL the database in turn with
it, one of its processes or the whole server; then says what was lost, and writes it into docs/security/durability.md.
"""

import argparse
import random
import re
import sys
import tempfile
import time
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path

from benchmarks.kills.database import Kill, kill_of_all, kill_of_one, sync_as_delivered
from benchmarks.kills.load import Load
from benchmarks.kills.server import Service, free_port
from service.settings import Settings
from tests.databases import Databases, PostgresDatabases, postgres_databases, sqlite_databases
from tests.service.storage.intact import faults

PAGE = Path(__file__).parents[2] / "docs" / "security" / "durability.md"
LONGEST = 5.0
"""Seconds from one start to the next kill at most: an upload takes some tenths of it on a machine that is not busy."""
ENGINES: dict[str, Callable[[], AbstractContextManager[Databases]]] = {
    "sqlite": sqlite_databases,
    "postgresql": postgres_databases,
    "postgresql-server": postgres_databases,
}
"""Engines, by the thing that is killed beside the service: nothing, a process of the database, or the whole server."""


@dataclass(frozen=True)
class Chosen:
    """Number of kills, and the load around them."""

    kills: int
    seed: int
    longest: float = LONGEST
    uploads: int = 0
    """Uploads that are acknowledged before each kill, and after the last."""


@dataclass(frozen=True)
class Seen:
    """Outcome of the kills."""

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
        sync_as_delivered(databases)
        kill = kill_of_database(given.engine, databases, settings)
        seen = killed(given.engine, settings, kill, Chosen(given.kills, given.seed))
    print(seen.row())
    print("\n".join([*seen.faults, *seen.load.refused][:20]), file=sys.stderr)
    text = given.page.read_text("utf-8")
    given.page.write_text(re.sub(rf"^\| {given.engine} \|.*$", seen.row(), text, flags=re.MULTILINE), "utf-8")
    return bool(seen.faults or seen.load.refused)


def kill_of_database(engine: str, databases: Databases, settings: Settings) -> Kill | None:
    """Function that kills the database; None for SQLite, which has no process of its own."""
    if not isinstance(databases, PostgresDatabases):
        return None
    return kill_of_all(databases) if engine == "postgresql-server" else kill_of_one(settings)


def killed(engine: str, settings: Settings, kill: Kill | None, chosen: Chosen) -> Seen:
    """Runs the load through so many kills; every second one is the database's, where it can be killed."""
    service, chance = Service(settings, free_port()), random.Random(chosen.seed)
    load, database_kills = Load(service.address, chosen.seed), 0
    service.start()
    with load.running():
        for number in range(chosen.kills):
            load.wait_for(chosen.uploads * (number + 1))
            time.sleep(chance.uniform(0.0, chosen.longest))
            if kill is not None and number % 2 == 0:
                kill()
                database_kills += 1
            else:
                service.kill()
                service.start()
        load.wait_for(chosen.uploads * (chosen.kills + 1))
    service.kill()
    service.start()
    found = faults(settings, load.acknowledged, load.sent)
    service.kill()
    return Seen(engine, chosen.kills - database_kills, database_kills, load, found)


if __name__ == "__main__":
    sys.exit(main())
