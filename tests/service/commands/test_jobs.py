"""`imu-health jobs` against a running service."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from service.commands import console
from tests.conftest import StockOf
from tests.databases import Databases
from tests.service.commands.conftest import Run
from tests.service.made_sessions import FAILED, session_bytes
from tests.serving import serving


@pytest.fixture
def receiving(sqlite: Databases, stock_of: StockOf, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """A running service, and a command, to which every file is a large one."""
    monkeypatch.setattr(console, "LARGE", 100)
    with (
        stock_of(sqlite).holding() as settings,
        serving(settings, later=100) as address,
    ):
        yield address


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


def test_a_large_file_is_followed_until_its_session_is_stored(run: Run, receiving: str, tmp_path: Path) -> None:
    file = tmp_path / "log.json"
    file.write_bytes(session_bytes())
    [receipt] = run("upload", file, "--json", "--server", receiving).documents
    assert (receipt["unit"], receipt["created"]) == ("BA-017", True)
    assert "upload of log.json" in run("jobs", "show", 1, "--server", receiving).out


def test_a_large_file_that_cannot_be_used_is_told_with_every_problem(run: Run, receiving: str, tmp_path: Path) -> None:
    file = tmp_path / "log.json"
    file.write_bytes(session_bytes().replace(b'"table": {', b'"table": {"A9": [1.0],'))
    ran = run("upload", file, "--server", receiving)
    assert (ran.code, "A9" in ran.err, "A9" in run("jobs", "show", 1, "--server", receiving).err) == (2, True, True)


def test_a_large_file_need_not_be_waited_for(run: Run, receiving: str, tmp_path: Path) -> None:
    file = tmp_path / "log.json"
    file.write_bytes(session_bytes())
    assert "log.json was received: job 1" in run("upload", file, "--no-wait", "--server", receiving).out
