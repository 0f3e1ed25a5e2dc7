"""`imu-health session` and `imu-health withdraw-service` against a running service."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.conftest import StockOf
from tests.databases import Databases
from tests.service.commands.conftest import Run
from tests.service.made_sessions import FAILED, session_bytes, session_id
from tests.serving import serving

SECOND = session_id(FAILED[1])


@pytest.fixture
def address(sqlite: Databases, stock_of: StockOf) -> Iterator[str]:
    """A running service with two sessions of a unit."""
    with stock_of(sqlite).holding(*FAILED) as settings, serving(settings) as address:
        yield address


def test_a_session_is_withdrawn_accepted_and_chosen(run: Run, address: str) -> None:
    own = (SECOND, "--by", "K. Ito", "--why", "cable", "--server", address)
    assert "withdrawn" in run("session", "withdraw", *own).out
    assert "accepted" in run("session", "accept", *own).out
    assert "reference" in run("session", "reference", *own).out
    assert run("session", "accept", *own).err.endswith("accepted already.\n")


def test_a_corrected_file_stands_for_a_stored_session(run: Run, address: str, tmp_path: Path) -> None:
    right = tmp_path / "right.json"
    right.write_bytes(session_bytes(seed=2, month=2))
    instead = ("--supersedes", SECOND, "--server", address)
    assert "why: is missing" in run("upload", right, *instead, "--by", "K. Ito").err
    assert "one corrected file" in run("upload", right, right, *instead).err
    assert "Fit" in run("upload", right, *instead, "--by", "K. Ito", "--why", "typing error").out
    again = run("session", "accept", SECOND, "--by", "K. Ito", "--why", "?", "--server", address)
    assert f"replaces session {SECOND}" in again.err


def test_a_service_is_withdrawn(run: Run, address: str) -> None:
    own = ("--by", "K. Ito", "--server", address)
    run("service", "BA-017", "repair", "--at", "2026-01-15", *own)
    assert "withdrawn" in run("withdraw-service", 1, "--why", "another unit", *own).out
