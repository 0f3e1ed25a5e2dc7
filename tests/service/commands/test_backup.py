"""`imu-health backup`, `restore` and `db upgrade --back-to`: nothing is deleted unasked, and all comes back."""

import os
import pty
from pathlib import Path

import httpx
import pytest

from service.app import create_app
from service.settings import Settings
from service.storage.audit import Audit
from tests.conftest import SettingsHolding
from tests.databases import Databases, one_engine
from tests.service.commands.conftest import Run
from tests.service.made_sessions import FAILED
from tests.service.storage.whole import files, rows
from tests.serving import http_client
from tests.stock import stores


@pytest.fixture
def full(settings_holding: SettingsHolding) -> Settings:
    """A service with a note."""
    settings = settings_holding(*FAILED)
    with http_client(create_app(settings)) as client:
        write_note(client)
    return settings


def write_note(client: httpx.Client) -> None:
    """Writes a note by hand."""
    client.post("/api/v1/units/BA-017/notes", json={"text": "dropped", "by": "K. Ito"}).raise_for_status()


def where(settings: Settings) -> tuple[object, ...]:
    """Options that name a service's stores."""
    return "--database-url", settings.database, "--data-folder", settings.data_folder


def test_backup_verify_and_restore(run: Run, full: Settings, databases: Databases, tmp_path: Path) -> None:
    file, new = tmp_path / "all.backup", Settings(database_url=databases.empty(), data_folder=tmp_path / "new")
    assert run("backup", *where(full), file).out.startswith(f"{file}: ")
    assert "2 files" in run("backup", file, "--check").out
    assert run("restore", file, *where(new)).code == 0
    after = rows(new.database)
    assert after["audit"].pop()[4:6] == ("restore", "backup")
    assert (after, files(new.files)) == (rows(full.database), files(full.files))
    with stores(new) as storage, storage.database.reading() as store:
        assert Audit(store).check().broken is None


@one_engine
def test_a_backup_without_a_lost_file_fails_so_that_somebody_looks(run: Run, full: Settings, tmp_path: Path) -> None:
    for path in full.files.glob("*/*"):
        path.write_bytes(b"changed")
    ran = run("backup", tmp_path / "all.backup", *where(full))
    assert (ran.code, "2 uploaded files are missing or damaged" in ran.err) == (1, True)
    assert run("backup", tmp_path / "all.backup", "--check").code == 0


def test_a_file_that_is_no_backup_is_said_on_one_line(run: Run, tmp_path: Path) -> None:
    (tmp_path / "other").write_text("something else")
    ran = run("backup", tmp_path / "other", "--check")
    assert (ran.code, ran.err.count("\n")) == (1, 1)


def test_a_downgrade_says_what_it_would_delete_and_does_nothing_unasked(run: Run, full: Settings) -> None:
    before = rows(full.database)
    ran = run("db", "upgrade", "--back-to", "0003", *where(full))
    assert ran.code == 1
    assert "Will be deleted from notes: 1 row\n" in ran.err
    assert "Say --yes" in ran.err
    assert rows(full.database) == before
    assert not list(full.data_folder.glob("*.backup"))


def test_a_downgrade_that_is_confirmed_writes_a_backup_that_brings_all_back(
    run: Run, full: Settings, databases: Databases, tmp_path: Path
) -> None:
    before = rows(full.database)
    assert run("db", "upgrade", "--back-to", "0003", "--yes", *where(full)).code == 0
    (backup,) = full.data_folder.glob("*.backup")
    new = Settings(database_url=databases.empty(), data_folder=tmp_path / "new")
    assert run("restore", backup, *where(new)).code == 0
    after = rows(new.database)
    assert (after["audit"].pop()[4], after) == ("restore", before)


@one_engine
def test_a_column_that_would_go_is_told_with_what_it_holds(run: Run, full: Settings) -> None:
    ran = run("db", "upgrade", "--back-to", "0008", *where(full))
    assert "Will be deleted from units: customer of 1 row, " in ran.err


@one_engine
@pytest.mark.parametrize(("answer", "code"), [("y", 0), ("n", 1)])
def test_at_a_terminal_the_answer_decides(
    run: Run, full: Settings, monkeypatch: pytest.MonkeyPatch, answer: str, code: int
) -> None:
    ours, theirs = pty.openpty()
    with os.fdopen(ours, "w") as typed, os.fdopen(theirs) as terminal:
        print(answer, file=typed, flush=True)
        monkeypatch.setattr("sys.stdin", terminal)
        assert run("db", "upgrade", "--back-to", "0003", "--no-backup", *where(full)).code == code
    assert not list(full.data_folder.glob("*.backup"))
