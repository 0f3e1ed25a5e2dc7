"""`imu-health upload` of a large file to a running service."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from service.commands import console
from tests.conftest import StockOf
from tests.databases import Databases
from tests.service.commands.conftest import Run
from tests.service.made_sessions import session_bytes
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


def test_a_large_file_is_followed_until_its_session_is_stored(run: Run, receiving: str, tmp_path: Path) -> None:
    file = tmp_path / "log.json"
    file.write_bytes(session_bytes())
    [receipt] = run("upload", file, "--json", "--server", receiving).documents
    assert (receipt["unit"], receipt["created"]) == ("BA-017", True)


def test_a_large_file_that_cannot_be_used_is_told_with_every_problem(run: Run, receiving: str, tmp_path: Path) -> None:
    file = tmp_path / "log.json"
    file.write_bytes(session_bytes().replace(b'"table": {', b'"table": {"A9": [1.0],'))
    ran = run("upload", file, "--server", receiving)
    assert (ran.code, "A9" in ran.err) == (2, True)


def test_a_large_file_need_not_be_waited_for(run: Run, receiving: str, tmp_path: Path) -> None:
    file = tmp_path / "log.json"
    file.write_bytes(session_bytes())
    assert "log.json was received: job 1" in run("upload", file, "--no-wait", "--server", receiving).out
