"""`imu-health serve`, as a process of its own, and `db`."""

import re
import signal
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import pytest

from service.commands.serve import _first_link as first_link
from service.opening import open_database
from service.settings import Settings
from tests.databases import Databases
from tests.service.commands.conftest import COMMAND, ENTRYPOINT, READY, Run
from tests.serving import serving


@dataclass(frozen=True)
class Start:
    """Output of a service from its start to its end, and answers in between."""

    printed: str
    ready: int
    fleet: dict[str, Any]


def start(folder: Path) -> Start:
    """The service as the container's entrypoint starts it."""
    environment = {
        "PATH": f"{COMMAND.parent}:/usr/bin:/bin",
        "IMU_HEALTH_PORT": "0",
        "IMU_HEALTH_DATA_FOLDER": str(folder),
        "IMU_HEALTH_DIAGNOSIS_WORKERS": "1",
    }
    with subprocess.Popen(
        ["/bin/sh", ENTRYPOINT], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=environment
    ) as process:
        assert process.stdout is not None
        first = process.stdout.readline()
        try:
            address = first.strip().removeprefix(READY)
            ready = httpx.get(f"{address}/readyz").status_code
            fleet = httpx.get(f"{address}/api/v1/fleet").json()
        finally:
            process.send_signal(signal.SIGINT)
        return Start(first + process.stdout.read(), ready, fleet)


def test_an_empty_service_starts_and_prints_a_link_only_until_somebody_has_an_account(run: Run, tmp_path: Path) -> None:
    first = start(tmp_path)
    assert (first.ready, first.fleet["units"]) == (200, 0)
    assert re.search(r"make the first account: http://127\.0\.0\.1:\d+/sign-in/\S{43}", first.printed)
    assert run("user", "add", "k.ito", "--role", "admin", "--data-folder", tmp_path).code == 0
    settings = Settings(data_folder=tmp_path)
    assert first_link(settings) is None
    with serving(settings) as address:
        assert httpx.get(f"{address}/readyz").status_code == 200
        assert httpx.get(f"{address}/api/v1/fleet").status_code == 401


def test_the_container_s_entrypoint_runs_other_commands() -> None:
    done = subprocess.run(
        ["/bin/sh", ENTRYPOINT, "simulate", "--help"],
        env={"PATH": f"{COMMAND.parent}:/usr/bin:/bin"},
        capture_output=True,
        text=True,
        check=True,
    )
    assert "--drift" in done.stdout


def test_db_upgrade_and_downgrade(run: Run, databases: Databases) -> None:
    url = databases.empty()
    assert run("db", "upgrade", "--database-url", url).code == 0
    ready = open_database(url)
    ready.require_ready()
    ready.close()
    assert run("db", "upgrade", "--back-to", "-1", "--database-url", url).code == 0
    assert run("db", "upgrade", "--back-to", "base", "--database-url", url).code == 0
    assert run("db", "upgrade", "--database-url", url).code == 0


def test_a_database_that_does_not_answer_is_said_on_one_line(run: Run) -> None:
    ran = run("db", "upgrade", "--database-url", "postgresql://nobody@127.0.0.1:1/none")
    assert (ran.code, ran.err.count("\n")) == (1, 1)


@pytest.mark.parametrize("url", ["nonsense", "mysql://host/name", "postgresql://user:secret@host:port/name"])
def test_an_address_that_is_none_is_told_what_one_looks_like(run: Run, url: str) -> None:
    ran = run("db", "upgrade", "--database-url", url)
    assert (ran.code, ran.err.count("\n")) == (1, 1)
    assert "sqlite:///path" in ran.err
    assert "secret" not in ran.err


def test_a_file_that_is_no_database_is_said_on_one_line(run: Run, tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("not a database, but long enough to be taken for one " * 100)
    ran = run("db", "upgrade", "--database-url", f"sqlite:///{tmp_path / 'notes.txt'}")
    assert (ran.code, ran.err.count("\n")) == (1, 1)


@pytest.mark.parametrize("folder", ["/sys/imu-health", "/dev/null/imu-health"])
def test_a_folder_that_cannot_be_written_is_named_at_the_start(run: Run, folder: str, store_url: str) -> None:
    ran = run("serve", "--port", 0, "--data-folder", folder, "--database-url", store_url)
    assert (ran.code, ran.err.count("\n")) == (1, 1)
    assert folder in ran.err
    assert "IMU_HEALTH_DATA_FOLDER" in ran.err


def test_a_setting_that_makes_no_sense_is_named(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("IMU_HEALTH_PORT", "many")
    ran = run("db", "upgrade")
    assert ran.code == 1
    assert "port" in ran.err
