"""`imu-health user`, `token` and `audit` on a database."""

import re
from datetime import UTC, datetime
from pathlib import Path

import httpx
import pytest

from service.kit.person import Role
from service.papers.sealing import seal_of
from service.settings import Settings
from service.storage import Storage
from tests.conftest import StockOf
from tests.databases import Databases
from tests.service.commands.conftest import Run
from tests.service.made_sessions import FAILED, session_id
from tests.service.people.staff import PASSWORD, staffed
from tests.service.people.test_audit import tampered
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
    assert "may not sign in" in run("user", "list", "--format", "table", *own).out
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


def test_a_certificate_is_signed_at_the_terminal(
    run: Run, sqlite: Databases, stock_of: StockOf, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with stock_of(sqlite).holding(*FAILED) as settings, stores(settings) as storage:
        staff = staffed(storage, datetime.now(UTC), signing=("engineer",))
        monkeypatch.setenv("IMU_HEALTH_TOKEN", staff.tokens[Role.ENGINEER])
        id = session_id(FAILED[-1])
        with serving(settings) as address:
            own = ("--server", address)
            wanted = ("sign", id, "--meaning", "reviewed", *own)
            assert "ask for it, read it" in run(*wanted).err
            assert run("certificate", id, "--out", tmp_path / "c.pdf", *own).code == 0
            monkeypatch.setattr("getpass.getpass", lambda *_, **__: PASSWORD)
            ran = run(*wanted)
            assert (ran.code, ran.out.strip()) == (0, f"{id}-0-1  reviewed by Engineer")
            assert "reviewed already, by Engineer" in run(*wanted).err


def test_a_trial_key_is_made_once_and_says_what_it_is(run: Run, tmp_path: Path) -> None:
    file = tmp_path / "seal.pem"
    assert "a key for trial" in run("seal", "trial", "--out", file).err
    assert (file.stat().st_mode & 0o777, b"BEGIN CERTIFICATE" in file.read_bytes()) == (0o600, True)
    assert run("seal", "trial", "--out", file).code == 1
    seal = seal_of(file, None)
    assert seal is not None
    assert "TRIAL (not trusted)" in seal.subject


def test_an_account_is_connected_with_somebody_elsewhere(
    run: Run, settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    own = ("--database-url", settings.database)
    run("user", "add", "k.ito", "--role", "admin", *own)
    assert "No provider is set" in run("user", "connect", "k.ito", "4711", *own).err
    monkeypatch.setenv("IMU_HEALTH_OIDC_ISSUER", "https://login.example.org")
    assert "k.ito signs in at https://login.example.org" in run("user", "connect", "k.ito", "4711", *own).out
    assert "connected with that one already" in run("user", "connect", "k.ito", "4711", *own).err
