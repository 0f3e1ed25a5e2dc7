"""Services that start together on an empty database: each ends at head and none dies; a newer schema is said."""

import subprocess
import sys

import pytest
from sqlalchemy import text

from service.errors import ServiceError
from service.storage import Database
from service.storage.schema import upgrade
from tests.databases import Databases

TOGETHER = 4
SCRIPT = """
import sys
from service.storage.schema import upgrade
print("ready", flush=True)
sys.stdin.readline()
upgrade(sys.argv[1])
"""


def test_processes_that_upgrade_an_empty_database_together_all_succeed(databases: Databases) -> None:
    url = databases.empty()
    processes = [
        subprocess.Popen(
            [sys.executable, "-c", SCRIPT, url],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        for _ in range(TOGETHER)
    ]
    for process in processes:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
    for process in processes:
        assert process.stdin is not None
        process.stdin.write("go\n")
        process.stdin.flush()
    left = [process.communicate(timeout=120)[1] for process in processes]
    assert ([process.returncode for process in processes], left) == ([0] * TOGETHER, [""] * TOGETHER)
    database = Database(url)
    database.require_ready()
    database.close()


def test_a_schema_of_a_newer_version_is_said_in_words_and_left_alone(databases: Databases) -> None:
    database = Database(databases.migrated())
    with database.engine.begin() as connection:
        connection.execute(text("UPDATE alembic_version SET version_num = '9999'"))
    with pytest.raises(ServiceError, match="a newer version made it"):
        upgrade(database.url)
    with database.engine.connect() as connection:
        assert connection.scalar(text("SELECT version_num FROM alembic_version")) == "9999"
    database.close()


def test_a_revision_that_there_is_not_is_said_in_words(databases: Databases) -> None:
    with pytest.raises(ServiceError, match="cannot be brought to 'nonsense'"):
        upgrade(databases.empty(), "nonsense")
