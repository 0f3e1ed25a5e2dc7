"""`imu-health user`, `token` and `audit` on a database."""

import re
from pathlib import Path

import httpx
import pytest

from service.settings import Settings
from service.storage import Storage
from tests.conftest import StockOf
from tests.databases import Databases
from tests.service.cli.conftest import Run
from tests.service.identity.test_audit import tampered
from tests.serving import serving
from tests.stock import stores


@pytest.fixture
def settings(sqlite: Databases, stock_of: StockOf):
    """Of an empty service."""
    with stock_of(sqlite).holding() as found:
        yield found


@pytest.fixture
def storage(settings: Settings):
    with stores(settings) as found:
        yield found


def test_an_account_is_made_signs_in_and_is_kept_out(run: Run, settings: Settings) -> None:
    own = ("--database-url", settings.database)
    link = run("user", "add", "k.ito", "--role", "admin", "--name", "K. Ito", *own).out.strip()
    path = re.fullmatch(r"http://127\.0\.0\.1:8000(/sign-in/\S+)", link)
    assert path is not None
    with serving(settings) as address, httpx.Client(base_url=address) as browser:
        assert browser.post(path[1], data={"password": "correct horse battery"}).status_code == 303
        assert browser.get("/api/v1/me").json()["name"] == "K. Ito"
    run("user", "add", "second", "--role", "admin", *own)
    assert "may not sign in" in run("user", "change", "k.ito", "--inactive", *own).out
    assert "may not sign in" in run("user", "list", *own).out
    assert "only account" in run("user", "change", "second", "--role", "crew", *own).err


def test_a_token_opens_the_service_for_commands(
    run: Run, settings: Settings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    own = ("--database-url", settings.database)
    run("user", "add", "bench", "--role", "admin", *own)
    secret = run("token", "add", "bench", "--role", "viewer", "--label", "bench 3", *own).out.strip()
    assert secret not in run("token", "list", *own).out
    with serving(settings) as address:
        assert "Sign in first" in run("fleet", "--server", address).err
        monkeypatch.setenv("IMU_HEALTH_TOKEN", secret)
        assert run("fleet", "--server", address).code == 0
        run("token", "revoke", "1", *own)
        assert "revoked" in run("fleet", "--server", address).err


def test_the_trail_is_verified(run: Run, settings: Settings, storage: Storage) -> None:
    own = ("--database-url", settings.database)
    run("user", "add", "k.ito", "--role", "admin", *own)
    last = run("audit", "verify", *own).out.split()[-1]
    assert run("audit", "verify", "--expect", last, *own).code == 0
    assert run("audit", "verify", "--expect", "0" * 64, *own).code == 1
    assert "add account" in run("audit", "list", "--subject", "k.ito", *own).out
    tampered(storage, "UPDATE audit SET who = 'nobody' WHERE id = 1")
    found = run("audit", "verify", *own)
    assert (found.code, "Line 1 does not follow" in found.err) == (1, True)
