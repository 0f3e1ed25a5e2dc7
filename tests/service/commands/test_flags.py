"""`imu-health flags` against a running service."""

from collections.abc import Iterator
from datetime import UTC, datetime

import httpx
import pytest

from service.flags.records import Concern, Matter
from service.records.flagging.acts import Occasion, raise_flag
from service.units.store import Units
from tests.conftest import StockOf
from tests.databases import Databases
from tests.service.commands.conftest import Run
from tests.service.made_sessions import FAILED
from tests.serving import serving
from tests.stock import stores

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)


@pytest.fixture
def address(sqlite: Databases, stock_of: StockOf) -> Iterator[str]:
    """A running service with one flag."""
    with stock_of(sqlite).holding(*FAILED) as settings, serving(settings) as address:
        yield address


def test_open_flags_are_shown(run: Run, address: str) -> None:
    ran = run("flags", "--table", "--server", address)
    assert ran.code == 0
    assert ran.out.splitlines()[1].split()[:3] == ["1", "BA-017", "raised"]


@pytest.mark.slow
def test_more_open_flags_than_a_page_holds_are_all_shown(run: Run, sqlite: Databases, stock_of: StockOf) -> None:
    with stock_of(sqlite).holding(*FAILED) as settings:
        with stores(settings) as storage, storage.database.writing() as store:
            occasion = Occasion(Units(store).key("BA-017"), None, NOW)
            for number in range(1000):
                raise_flag(store, occasion, Concern(Matter.CAUSE, str(number), 1, "seen"))
        with serving(settings) as address:
            assert len(run("flags", "--json", "--server", address).documents) == 1001
            assert len(run("flags", "--state", "raised", "--json", "--server", address).documents) == 1001


def test_a_settled_flag_is_no_longer_open(run: Run, address: str) -> None:
    done = {"by": "K. Ito", "why": "A3 replaced"}
    httpx.post(f"{address}/api/v1/flags/1/resolve", json=done).raise_for_status()
    assert run("flags", "--table", "--server", address).out == "No flag is open.\n"
    [flag] = run("flags", "--state", "resolved", "--server", address).documents
    assert [change["who"] for change in flag["changes"]] == ["imu-health", "K. Ito"]


def test_flags_are_given_to_somebody_and_found_by_the_name(run: Run, address: str) -> None:
    assert run("flags", "--assigned", "M. Sato", "--server", address).out == ""
    given = {"to": "M. Sato", "by": "K. Ito"}
    httpx.post(f"{address}/api/v1/flags/1/assign", json=given).raise_for_status()
    [flag] = run("flags", "--assigned", "M. Sato", "--json", "--server", address).documents
    assert flag["assignee"] == "M. Sato"
