"""`imu-health jobs` against a running service."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.conftest import StockOf
from tests.databases import Databases
from tests.service.cli.conftest import Run
from tests.service.sessions import FAILED
from tests.serving import serving


@pytest.fixture
def address(sqlite: Databases, stock_of: StockOf) -> Iterator[str]:
    """A running service with one unit."""
    with stock_of(sqlite).holding(*FAILED) as settings, serving(settings) as address:
        yield address


def test_a_report_is_asked_for_followed_and_fetched(run: Run, address: str, tmp_path: Path) -> None:
    [asked] = run("jobs", "report", "--format", "xlsx", "--by", "K. Ito", "--json", "--server", address).documents
    target = tmp_path / "fleet.xlsx"
    ran = run("jobs", "show", asked["id"], "--wait", "--out", target, "--server", address)
    assert (ran.code, target.read_bytes()[:2]) == (0, b"PK")
    assert "done" in run("jobs", "--format", "table", "--server", address).out.splitlines()[1]


def test_what_has_ended_is_not_cancelled(run: Run, address: str) -> None:
    own = ("--by", "K. Ito", "--server", address)
    assert "done" in run("jobs", "recalibrate", "--scope", "unit", "--name", "BA-017", *own).out
    ran = run("jobs", "cancel", 1, *own)
    assert (ran.code, "has ended already" in ran.err) == (1, True)
