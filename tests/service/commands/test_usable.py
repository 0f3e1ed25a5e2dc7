"""`imu-health usable` against a running service."""

from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path

import httpx
import pytest

from service.settings import Settings
from tests.databases import Databases
from tests.service.commands.conftest import Run
from tests.service.made_sessions import FAILED, session_bytes
from tests.serving import serving


@pytest.fixture
def address(sqlite: Databases, tmp_path: Path) -> Iterator[str]:
    """A running service that holds a unit out of tolerance."""
    with serving(Settings(database_url=sqlite.migrated(), data_folder=tmp_path / "data")) as address:
        for content in FAILED:
            httpx.post(f"{address}/api/v1/sessions", content=content).raise_for_status()
        yield address


def test_an_unfit_unit_ends_with_one(run: Run, address: str) -> None:
    ran = run("usable", "BA-017", "--server", address)
    assert ran.code == 1
    assert "Do not use: adjust, repair or withdraw it" in ran.out
    [answer] = run("usable", "BA-017", "--server", address, "--json").documents
    assert answer["usable"] is False


def test_a_fit_unit_ends_with_zero(run: Run, address: str) -> None:
    for seed, days in ((1, 20), (2, 1)):
        at = datetime.now(UTC) - timedelta(days=days)
        content = session_bytes(unit="BA-100", seed=seed, started_at=at.isoformat())
        httpx.post(f"{address}/api/v1/sessions", content=content).raise_for_status()
    ran = run("usable", "BA-100", "--server", address)
    assert (ran.code, "May be used" in ran.out) == (0, True)


def test_an_unknown_unit_is_never_usable(run: Run, address: str) -> None:
    ran = run("usable", "none", "--server", address)
    assert (ran.code, ran.out) == (1, "")
    assert "There is no unit" in ran.err
