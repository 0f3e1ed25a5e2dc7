"""Fixtures of all tests: databases of both engines, and services on them that are empty or hold sessions already."""

import gc
import os
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from functools import cache, partial, partialmethod

import httpx
import pytest
from argon2 import PasswordHasher
from argon2.profiles import CHEAPEST
from hypothesis import HealthCheck
from hypothesis import settings as hypothesis_settings
from sqlalchemy import create_engine
from sqlalchemy.orm import Mapper

from service.app import create_app
from service.kit.lock_order import WATCHED
from service.people import secret as passwords
from service.settings import Settings
from service.storage import Storage, engine
from service.work.readers import GroupReader, Reader
from tests.databases import Compiled, Databases, PostgresDatabases, postgres_databases, sqlite_databases
from tests.databases import all_in_turn as pytest_generate_tests  # noqa: F401 - the hook
from tests.memory import write_into_memory
from tests.patience import LONG
from tests.serving import http_client
from tests.stock import Fill, Stock, stores

os.environ.setdefault("IMU_HEALTH_DIAGNOSIS_WORKERS", "0")
os.environ[WATCHED] = "yes"
"""Diagnoses are made when they are read: a test that looks at none does not pay for it. Those of the processes that
make them say how many they want."""

SettingsHolding = Callable[..., Settings]
Holding = Callable[..., httpx.Client]
SettingsFilled = Callable[[Fill], Settings]
Filled = Callable[[Callable[[Storage], object]], Storage]
StockOf = Callable[[Databases], Stock]


def be_patient() -> None:
    """Removes time limits: by default httpx gives up after 5 s, and Hypothesis after 0.2 s."""
    for phase in ("connect", "read", "write", "pool"):
        setattr(httpx._config.DEFAULT_TIMEOUT_CONFIG, phase, LONG)
    hypothesis_settings.register_profile("patient", deadline=None, suppress_health_check=[HealthCheck.too_slow])
    hypothesis_settings.load_profile("patient")


def pytest_configure(config: pytest.Config) -> None:
    """Sets time limits; the first process chooses the folder that all workers write to."""
    be_patient()
    if not hasattr(config, "workerinput"):
        write_into_memory()


LONGEST = tuple(f"tests/{file}.py" for file in (
    "service/commands/test_demo", "service/web/test_schema", "estimator/health/test_backtest", "blind/test_blind"
))  # fmt: skip
"""Files in which one test or what it rests on takes a quarter of a minute: begun last, they would be waited for."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """The longest first."""
    items.sort(key=lambda item: not item.nodeid.startswith(LONGEST))


RARELY = 20_000
"""New objects between two looks for garbage: every 700, as Python has it, takes a tenth of the time."""


def pytest_collection_finish() -> None:
    """Keeps imported and collected objects to the end: no garbage collection looks at them again."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(RARELY, *gc.get_threshold()[1:])


@pytest.fixture(scope="session", autouse=True)
def light_passwords() -> Iterator[None]:
    """Passwords hashed with the least work: with the product's, a sixth of a second each, accounts are slow to make."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(passwords, "_hasher", cache(lambda: PasswordHasher.from_parameters(CHEAPEST)))
        yield


@pytest.fixture(scope="session", autouse=True)
def compiled_once() -> Iterator[None]:
    """Every engine takes its statements from one cache, and so do the mappers that write rows."""
    compiled = Compiled()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(engine, "create_engine", partial(create_engine, execution_options={"compiled_cache": compiled}))
        patch.setattr(Mapper, "_compiled_cache", compiled)
        yield


@pytest.fixture
def patient_readers(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whoever asks for what the workers make is let wait until it is there; the service itself asks the clients of a
    slow machine to come again."""
    for reader, name in ((Reader, "read"), (Reader, "until_dated"), (GroupReader, "read")):
        monkeypatch.setattr(reader, name, partialmethod(getattr(reader, name), patience=LONG))


@pytest.fixture(scope="session", autouse=True)
def summarised() -> Iterator[None]:
    """Pages wait until the fleet is summarised, however slow the machine."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Reader, "until_summarised", partialmethod(Reader.until_summarised, patience=LONG))
        yield


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


@pytest.fixture
def databases(request: pytest.FixtureRequest) -> Databases:
    """The engine of this test."""
    chosen: Databases = request.getfixturevalue(request.param)
    return chosen


@pytest.fixture(scope="session")
def stock_of(tmp_path_factory: pytest.TempPathFactory) -> StockOf:
    """The services of an engine that this worker has filled so far."""
    return cache(lambda databases: Stock(databases, tmp_path_factory.mktemp("stock")))


@pytest.fixture
def settings_holding(databases: Databases, stock_of: StockOf) -> Iterator[SettingsHolding]:
    """Settings of a service that holds uploads already."""
    with ExitStack() as opened:
        yield lambda *uploads, diagnosed=False: opened.enter_context(
            stock_of(databases).holding(*uploads, diagnosed=diagnosed)
        )


@pytest.fixture
def holding(settings_holding: SettingsHolding) -> Iterator[Holding]:
    """HTTP to a service that holds uploads already."""
    with ExitStack() as opened:
        yield lambda *uploads, diagnosed=False: opened.enter_context(
            http_client(create_app(settings_holding(*uploads, diagnosed=diagnosed)))
        )


@pytest.fixture
def settings_filled(databases: Databases, stock_of: StockOf) -> Iterator[SettingsFilled]:
    """Settings of a service that a function has filled, once for all tests."""
    with ExitStack() as opened:
        yield lambda fill: opened.enter_context(stock_of(databases).filled(fill))


@pytest.fixture
def filled(settings_filled: SettingsFilled) -> Iterator[Filled]:
    """The stores that a function has filled, once for all tests, without the service."""
    with ExitStack() as opened:
        yield lambda fill: opened.enter_context(stores(settings_filled(_by_stores(fill))))


@cache
def _by_stores(fill: Callable[[Storage], object]) -> Fill:
    def by_settings(settings: Settings) -> None:
        with stores(settings) as storage:
            fill(storage)

    return by_settings


@pytest.fixture
def settings(settings_holding: SettingsHolding) -> Settings:
    """Settings of an empty service."""
    return settings_holding()


@pytest.fixture
def store_url(settings: Settings) -> str:
    """A fresh database with its schema at head."""
    return settings.database


@pytest.fixture
def storage(settings: Settings) -> Iterator[Storage]:
    """The stores of an empty service, without the service."""
    with stores(settings) as found:
        yield found


@pytest.fixture
def client(settings: Settings) -> Iterator[httpx.Client]:
    """HTTP to an empty service."""
    with http_client(create_app(settings)) as http:
        yield http
