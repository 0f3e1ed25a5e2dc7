"""`imu-health models` against a running service."""

from collections.abc import Iterator
from datetime import UTC, datetime

import pytest

from service.models.records import ModelRevision, Scope
from service.models.store import Models
from tests.conftest import StockOf
from tests.databases import Databases
from tests.service.commands.conftest import Run
from tests.service.grouped import CUBIC, cubic_session
from tests.service.made_sessions import session_id
from tests.serving import serving
from tests.stock import stores

REVISION = ModelRevision(
    0, Scope.UNIT, "BA-017", "warm-up", ("A2",), session_id(cubic_session(0, cubic=4 * CUBIC)), None, "K. Ito", "",
    datetime(2026, 11, 21, 12, tzinfo=UTC),
)  # fmt: skip
GROUP = tuple(cubic_session(number, cubic=4 * CUBIC) for number in range(4))


@pytest.fixture
def address(sqlite: Databases, stock_of: StockOf) -> Iterator[str]:
    """A running service with four sessions that show a cubic term together."""
    with stock_of(sqlite).holding(*GROUP) as settings, serving(settings) as address:
        yield address


def test_what_sessions_show_is_accepted_shown_and_withdrawn(run: Run, address: str) -> None:
    own = ("--by", "K. Ito", "--why", "bench", "--server", address)
    assert run("models", "--format", "table", "--server", address).out == "No cause is accepted.\n"
    accepted = run("models", "accept", "unit", "BA-017", "cubic-nonlinearity", *own)
    assert accepted.out.splitlines()[0].startswith("Revision 1  cubic-nonlinearity (A2)  of unit BA-017, accepted by")
    assert "4 of 4 sessions" in accepted.out
    assert "withdraws revision 1 by K. Ito" in run("models", "withdraw", 1, *own).out
    assert [d["withdraws"] for d in run("models", "--json", "--server", address).documents] == [1, None]


def test_what_they_do_not_show_is_refused_on_one_line(run: Run, address: str) -> None:
    ran = run("models", "accept", "unit", "BA-017", "hysteresis", "--by", "K. Ito", "--server", address)
    assert (ran.code, ran.out, ran.err.count("\n")) == (1, "", 1)
    assert "not among the causes that these sessions show together" in ran.err


def test_more_revisions_than_a_page_holds_are_all_shown(run: Run, sqlite: Databases, stock_of: StockOf) -> None:
    with stock_of(sqlite).holding(GROUP[0]) as settings:
        with stores(settings) as storage, storage.database.writing() as store:
            for _ in range(1001):
                Models(store).add(REVISION)
        with serving(settings) as address:
            assert len(run("models", "--json", "--server", address).documents) == 1001
