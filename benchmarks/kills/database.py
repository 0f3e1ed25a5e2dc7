"""The database's processes, ended with `kill -9`: one of them, or all at once."""

import os
import signal
import time
from collections.abc import Callable

import psutil
import psycopg

from service.settings import Settings
from tests.databases import Databases, PostgresDatabases

ATTEMPTS, PAUSE = 600, 0.1
"""Attempts to reach a database that recovers, and the seconds between them."""
ENDED = 10.0
"""Seconds in which the kernel takes away what was killed."""

Kill = Callable[[], None]


def sync_as_delivered(databases: Databases) -> None:
    """Tests let PostgreSQL sync nothing, as they do not cut the power; from now on it does, as it is delivered."""
    if isinstance(databases, PostgresDatabases):
        with psycopg.connect(databases.server.get_uri(), autocommit=True) as connection:
            for statement in ("ALTER SYSTEM RESET ALL", "SELECT pg_reload_conf()", "CHECKPOINT"):
                connection.execute(statement)


def kill_of_one(settings: Settings) -> Kill:
    """Ends one: the server ends all others too, and recovers from its log."""

    def kill() -> None:
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

    return kill


def kill_of_all(databases: PostgresDatabases) -> Kill:
    """Ends the server and everything that it started, with nobody left to tidy up, and starts it again."""
    server = databases.server

    def kill() -> None:
        head = psutil.Process(server.get_pid())
        own = [head, *head.children(recursive=True)]
        for process in own:
            process.suspend()  # so that none sees another go
        for process in own:
            process.kill()
        psutil.wait_procs(own, ENDED)
        server.ensure_postgres_running()

    return kill
