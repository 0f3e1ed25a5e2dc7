"""`imu-health customer`, `stand-certificate`, `report label` and `usable` against a running service."""

from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path

import httpx
import pytest

from service.settings import Settings
from tests.databases import Databases
from tests.patience import LONG
from tests.service.commands.conftest import Run
from tests.service.made_sessions import FAILED, session_bytes, session_id
from tests.service.papers.documents import text_of
from tests.serving import serving


@pytest.fixture
def address(sqlite: Databases, tmp_path: Path) -> Iterator[str]:
    """A running service that holds a unit out of tolerance."""
    with serving(Settings(database_url=sqlite.migrated(), data_folder=tmp_path / "data")) as address:
        for content in FAILED:
            httpx.post(f"{address}/api/v1/sessions", content=content).raise_for_status()
        yield address


def test_customer_and_stand_are_named(run: Run, address: str) -> None:
    named = run("customer", "BA-017", "Aero Works Ltd", "--address", "Derby", "--by", "K. Ito", "--server", address)
    dates = ("--issued-on", "2025-01-10", "--valid-until", "2026-01-10")
    number = ("--number", "D-K-117", "--issued-by", "PTB", "--by", "K. Ito")
    kept = run("stand-certificate", "ODG-1", *number, *dates, "--server", address)
    assert (named.code, kept.code) == (0, 0)
    assert "valid until 2026-01-10" in kept.out
    session = httpx.get(f"{address}/api/v1/sessions/{session_id(FAILED[-1])}").json()
    assert session["stand_certificate_expired"]


def test_certificates_on_a_stand_that_was_found_bad_are_listed(run: Run, address: str) -> None:
    stand = ("stand-affected", "ODG-1", "--server", address, "--format", "table")
    assert "No certificate rests on it." in run(*stand).out
    id = session_id(FAILED[-1])
    httpx.get(f"{address}/api/v1/sessions/{id}/certificate?format=dcc", timeout=LONG).raise_for_status()
    assert id in run(*stand, "--since", "2026-02-01", "--until", "2026-02-01").out
    assert id not in run(*stand, "--until", "2025-12-31").out


def test_the_label_is_written(run: Run, address: str, tmp_path: Path) -> None:
    target = tmp_path / "label.pdf"
    assert run("report", "label", "BA-017", "--out", target, "--server", address).code == 0
    assert "BA-017" in text_of(target.read_bytes())


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
