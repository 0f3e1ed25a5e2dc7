"""Services that start together on an empty database: each ends at head and none dies; a newer schema is said."""

import subprocess
import sys

import pytest
from sqlalchemy import text

from service.errors import ServiceError
from service.opening import open_database
from service.storage.schema import upgrade
from tests.databases import Databases
from tests.patience import LONG

SCRIPT = """
import multiprocessing, sys
from service.storage.schema import upgrade

def work(url, together):
    together.wait()
    upgrade(url)

fork = multiprocessing.get_context("fork")
together = fork.Barrier(4)
processes = [fork.Process(target=work, args=(sys.argv[1], together)) for _ in range(4)]
for process in processes:
    process.start()
for process in processes:
    process.join()
    print(process.exitcode)
"""


@pytest.mark.slow
def test_processes_that_upgrade_an_empty_database_together_all_succeed(databases: Databases) -> None:
    url = databases.empty()
    command = [sys.executable, "-c", SCRIPT, url]
    done = subprocess.run(command, capture_output=True, text=True, timeout=LONG, check=True)
    assert (done.stdout.split(), done.stderr) == (["0"] * 4, "")
    database = open_database(url)
    database.require_ready()
    database.close()


def test_a_schema_of_a_newer_version_is_said_in_words_and_left_alone(databases: Databases) -> None:
    database = open_database(databases.migrated())
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
