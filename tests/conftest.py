"""What all tests share: databases of both engines, and the service on a fresh one of each."""

from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from service.app import create_app
from service.settings import Settings
from service.storage import Database, Files, Storage
from tests.databases import ENGINES, Databases, PostgresDatabases, postgres_databases, sqlite_databases
from tests.serving import http_client


@pytest.fixture(scope="session")
def sqlite() -> Iterator[Databases]:
    """Makes SQLite databases."""
    with sqlite_databases() as databases:
        yield databases


@pytest.fixture(scope="session")
def postgresql() -> Iterator[PostgresDatabases]:
    """Makes PostgreSQL databases, on one real server a worker."""
    with postgres_databases() as databases:
        yield databases


@pytest.fixture(params=ENGINES)
def databases(request: pytest.FixtureRequest) -> Databases:
    """Each engine in turn."""
    chosen: Databases = request.getfixturevalue(request.param)
    return chosen


@pytest.fixture
def store_url(databases: Databases) -> Iterator[str]:
    """A fresh database with its schema at head, of each engine in turn."""
    url = databases.migrated()
    yield url
    databases.drop(url)


@pytest.fixture
def settings(store_url: str, tmp_path: Path) -> Settings:
    """Settings of a service on the fresh database."""
    return Settings(database_url=store_url, data_folder=tmp_path / "data")


@pytest.fixture
def storage(settings: Settings) -> Iterator[Storage]:
    """The stores of the service, without the service."""
    database = Database(settings.database)
    yield Storage(database, Files(settings.files))
    database.close()


@pytest.fixture
def client(settings: Settings) -> Iterator[httpx.Client]:
    """HTTP to a service on a fresh database, of each engine in turn."""
    with http_client(create_app(settings)) as http:
        yield http
