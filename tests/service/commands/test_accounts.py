"""`imu-health user` and `token` on a database."""

import re
from pathlib import Path

import httpx
import pytest

from service.settings import Settings
from tests.conftest import StockOf
from tests.databases import Databases
from tests.service.commands.conftest import Run
from tests.serving import serving


@pytest.fixture
def settings(sqlite: Databases, stock_of: StockOf):
    """Settings of an empty service."""
    with stock_of(sqlite).holding() as found:
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
    assert "may not sign in" in run("user", "list", "--table", *own).out
    assert "only account" in run("user", "change", "second", "--role", "crew", *own).err


def test_a_name_or_label_that_is_no_text_is_refused_under_its_name(run: Run, settings: Settings) -> None:
    own = ("--database-url", settings.database)
    ran = run("user", "add", "k.ito", "--role", "admin", "--name", "K.\x1bIto", *own)
    assert (ran.code, "name" in ran.err, "U+001B" in ran.err) == (1, True, True)
    run("user", "add", "k.ito", "--role", "admin", *own)
    assert "U+000A" in run("user", "change", "k.ito", "--name", "K.\nIto", *own).err
    assert "U+000B" in run("token", "add", "k.ito", "--role", "crew", "--label", "a\vb", *own).err
    assert "longer" in run("token", "add", "k.ito", "--role", "crew", "--label", 201 * "a", *own).err


def test_a_token_opens_the_service_for_commands(
    run: Run, settings: Settings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    own = ("--database-url", settings.database)
    run("user", "add", "bench", "--role", "admin", *own)
    secret = run("token", "add", "bench", "--role", "viewer", "--label", "bench 3", *own).out.strip()
    assert secret not in run("user", "list", "--tokens", *own).out
    with serving(settings) as address:
        assert "Sign in first" in run("fleet", "--server", address).err
        monkeypatch.setenv("IMU_HEALTH_TOKEN", secret)
        assert run("fleet", "--server", address).code == 0
        run("token", "revoke", "1", *own)
        assert "revoked" in run("fleet", "--server", address).err
