"""`imu-health open`, and the ids that the next command needs."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.conftest import StockOf
from tests.databases import Databases
from tests.service.commands.conftest import Run
from tests.service.made_sessions import session_bytes, session_id
from tests.serving import serving

SESSION = session_bytes(unit="BA 017/2")


@pytest.fixture
def address(sqlite: Databases, stock_of: StockOf) -> Iterator[str]:
    """A running service with one unit."""
    with stock_of(sqlite).holding(SESSION) as settings, serving(settings) as address:
        yield address


def test_the_address_is_printed_and_opened(
    run: Run, address: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    browser = tmp_path / "browser"
    browser.write_text(f'#!/bin/sh\necho "$1" > {tmp_path}/opened\n')
    browser.chmod(0o755)
    monkeypatch.setenv("BROWSER", str(browser))
    ran = run("open", session_id(SESSION), "--server", address)
    assert (ran.code, ran.out) == (0, f"{address}/sessions/{session_id(SESSION)}\n")
    assert (tmp_path / "opened").read_text() == ran.out


def test_a_unit_and_the_fleet_have_addresses_too(run: Run, address: str) -> None:
    own = ("--no-browser", "--server", address)
    assert run("open", "BA 017/2", *own).out == f"{address}/units/BA%20017%2F2\n"
    assert run("open", *own).out == f"{address}/\n"
    ran = run("open", "nobody", *own)
    assert (ran.code, ran.out) == (1, "")


def test_an_upload_prints_the_id_that_other_commands_take(run: Run, address: str, tmp_path: Path) -> None:
    (tmp_path / "a.json").write_bytes(SESSION)
    assert session_id(SESSION) in run("upload", tmp_path / "a.json", "--no-wait", "--server", address).out
