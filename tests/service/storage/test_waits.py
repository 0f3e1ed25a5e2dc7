"""A database that is locked, frozen or silent is away after a while; nobody waits for ever."""

import os
import signal
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from time import monotonic

import pytest
from sqlalchemy import make_url, text

from service.app import create_app
from service.errors import AwayError
from service.opening import open_database
from service.settings import Settings
from service.storage import Database, waits
from service.storage.faults import database_faults
from service.storage.schema import alone
from service.storage.waits import Waits
from tests.databases import Databases, PostgresDatabases
from tests.patience import LONG
from tests.service.made_sessions import session_bytes
from tests.serving import http_client

SHORT = Waits(lock=0.3, statement=0.5, connect=2.0)
LONGEST = LONG / 2
"""Seconds: what is given up after one is given up within these on any machine."""


@contextmanager
def given_up() -> Iterator[None]:
    """Asserts that the work inside ends as away, and soon."""
    began = monotonic()
    with pytest.raises(AwayError):
        yield
    assert monotonic() - began < LONGEST


@contextmanager
def impatient(url: str) -> Iterator[Database]:
    """A database whose waits are short."""
    database = open_database(url, SHORT)
    yield database
    database.close()


@contextmanager
def frozen(pid: int) -> Iterator[None]:
    """A process that is stopped as a frozen machine is."""
    os.kill(pid, signal.SIGSTOP)
    yield
    os.kill(pid, signal.SIGCONT)


def test_a_lock_that_another_holds_is_not_waited_for_for_ever(settings: Settings) -> None:
    short = settings.model_copy(update={"database_seconds": 0.3})
    with http_client(create_app(short)) as client:
        with alone(settings.database) as holder:
            if holder.dialect.name == "postgresql":
                holder.execute(text("LOCK TABLE units"))
            answer = client.post("/api/v1/sessions", content=session_bytes())
        assert (answer.status_code, answer.headers["retry-after"]) == (503, "5")
        assert client.post("/api/v1/sessions", content=session_bytes()).status_code == 201


def test_a_statement_that_takes_too_long_is_ended_by_the_server(postgresql: PostgresDatabases) -> None:
    with impatient(postgresql.migrated()) as database:
        with given_up(), database_faults(), database.engine.connect() as connection:
            connection.execute(text("SELECT pg_sleep(600)"))
        database.require_ready()


def test_a_frozen_server_is_left_and_the_service_recovers(
    postgresql: PostgresDatabases, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(waits, "GRACE", 0.5)
    with impatient(postgresql.migrated()) as database:
        with database.engine.connect() as connection:
            pid = connection.scalar(text("SELECT pg_backend_pid()"))
            assert pid is not None
            with frozen(pid), given_up(), database_faults():
                connection.execute(text("SELECT 1"))
        database.require_ready()


def test_a_server_that_accepts_and_says_nothing_is_away() -> None:
    with socket.create_server(("127.0.0.1", 0)) as silent:
        port = silent.getsockname()[1]
        with impatient(f"postgresql://u:p@127.0.0.1:{port}/d") as database, given_up():
            database.require_ready()


def test_an_operator_s_own_options_win(postgresql: PostgresDatabases) -> None:
    url = make_url(postgresql.migrated()).update_query_dict({"options": "-c statement_timeout=77s"})
    with impatient(url.render_as_string(hide_password=False)) as database, database.engine.connect() as connection:
        assert connection.scalar(text("SHOW statement_timeout")) == "77s"
        assert connection.scalar(text("SHOW lock_timeout")) == "300ms"


def test_a_database_file_that_may_not_be_written_is_said_in_words(sqlite: Databases, tmp_path: Path) -> None:
    with pytest.raises(AwayError, match="cannot be opened or written"), impatient(f"sqlite:///{tmp_path}") as database:
        database.require_ready()
