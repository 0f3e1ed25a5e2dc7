"""`imu-health doctor`: every line says what it found, and what to do where something lacks."""

from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import pytest

from service.commands.doctor import CheckState, database, variables
from service.records.unit_changes import add_note
from service.settings import Settings
from service.storage import Storage
from service.storage.schema import downgrade
from tests.conftest import SettingsHolding
from tests.databases import Databases
from tests.service.commands.conftest import Run
from tests.service.made_sessions import session_bytes
from tests.stock import stores

NOW = datetime(2026, 11, 23, tzinfo=UTC)


@pytest.fixture(autouse=True)
def own_variables(monkeypatch: pytest.MonkeyPatch) -> None:
    """Sets variables, so that those of the machine do not matter."""
    monkeypatch.setenv("IMU_HEALTH_DIAGNOSIS_WORKERS", "1")


def examined(run: Run, *options: object) -> tuple[int, dict[str, dict[str, Any]]]:
    ran = run("doctor", "--json", *options)
    return ran.code, {line["what"]: line for line in ran.documents}


def test_a_sound_service_has_nothing_to_put_right(run: Run, settings: Settings) -> None:
    options = ("--database-url", settings.database, "--data-folder", settings.data_folder)
    code, lines = examined(run, *options)
    assert (code, {line["state"] for line in lines.values()}) == (0, {"ok"})
    assert {"python", "libraries", "settings", "folder", "disk", "database", "clock", "workers"} <= set(lines)
    assert "ok    database: " in run("doctor", *options).out


def test_before_the_first_start_no_database_is_made(run: Run, tmp_path: Path) -> None:
    code, lines = examined(run, "--data-folder", tmp_path)
    assert (code, lines["database"]["state"]) == (0, "warn")
    assert "imu-health serve" in lines["database"]["remedy"]
    assert list(tmp_path.glob("*.sqlite")) == []


def test_an_old_schema_fails_and_says_what_to_run(run: Run, databases: Databases, tmp_path: Path) -> None:
    url = databases.migrated()
    downgrade(url, "0018")
    code, lines = examined(run, "--database-url", url, "--data-folder", tmp_path)
    assert (code, lines["database"]["state"]) == (1, "fail")
    assert "imu-health db upgrade" in lines["database"]["text"]


def test_a_database_that_is_away_fails(run: Run, tmp_path: Path) -> None:
    url = "postgresql://nobody@127.0.0.1:9/none"
    code, lines = examined(run, "--database-url", url, "--data-folder", tmp_path)
    assert (code, lines["database"]["state"]) == (1, "fail")


def test_a_clock_that_is_behind_what_is_stored_fails(settings_holding: SettingsHolding) -> None:
    settings = settings_holding(session_bytes())
    with stores(settings) as storage:
        _write_later(storage)
    clock = next(one for one in database(settings, NOW) if one.what == "clock")
    assert clock.state is CheckState.FAIL


def _write_later(storage: Storage) -> None:
    later = NOW + timedelta(days=3)
    add_note(storage, "BA-017", "a", at=later, who="K. Ito", now=later)


def test_a_misspelt_setting_is_named_with_the_right_one(run: Run, tmp_path: Path) -> None:
    (found,) = variables({"IMU_HEALTH_MACHIN": "large", "IMU_HEALTH_PORT": "1", "HOME": "/"})
    assert (found.state, found.remedy) == (CheckState.WARN, "Did you mean IMU_HEALTH_MACHINE?")


@pytest.mark.parametrize("command", ["serve", "doctor"])
def test_a_setting_of_an_earlier_version_is_an_error_that_names_its_replacement(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: str
) -> None:
    monkeypatch.setenv("IMU_HEALTH_MAX_ROWS", "3")
    ran = run(command, "--data-folder", tmp_path)
    assert ran.code == 1
    assert "No longer read: IMU_HEALTH_MAX_ROWS. Unset it, and use IMU_HEALTH_MACHINE instead." in ran.out + ran.err
    assert list(tmp_path.iterdir()) == []


def test_what_cannot_be_is_a_line_each(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("IMU_HEALTH_PORT", "many")
    code, lines = examined(run, "--data-folder", tmp_path)
    assert (code, lines["settings"]["state"]) == (1, "fail")
    assert "IMU_HEALTH_PORT" in lines["settings"]["text"]


def test_settings_that_contradict_each_other_are_told(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name, value in {"SIGN_IN": "off", "HOST": "0.0.0.0", "OIDC_ISSUER": "https://login.example.org"}.items():
        monkeypatch.setenv(f"IMU_HEALTH_{name}", value)
    monkeypatch.setenv("IMU_HEALTH_SEAL_KEY_FILE", str(tmp_path / "none.pem"))
    code, lines = examined(run, "--data-folder", tmp_path)
    states = {what: lines[what]["state"] for what in ("sign-in", "address", "sign-in elsewhere", "secrets")}
    assert states == {"sign-in": "warn", "address": "warn", "sign-in elsewhere": "fail", "secrets": "fail"}
    assert code == 1
