"""A backup or a database that names files elsewhere leads nowhere else."""

import json
import zipfile
from collections.abc import Callable
from datetime import UTC, datetime
from hashlib import sha256
from pathlib import Path

import pytest
from sqlalchemy import text

from service.jobs.records import JobState
from service.jobs.store import Jobs
from service.kit.metrics import Metrics
from service.kit.person import EVERYBODY
from service.records.reception import Reception
from service.sessions.sent import SentFile
from service.settings import Settings
from service.storage.backup import write_backup
from service.uploads.take_in import ask_upload, take_in
from tests.databases import Databases
from tests.service.commands.conftest import Run
from tests.service.made_sessions import session_bytes
from tests.stock import stores

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
OUTSIDE = "../../precious"
"""Path from the folder of files that wait to the data folder's neighbours."""


def backup_with(settings: Settings, folder: Path, table: str, change: Callable[[bytes], bytes]) -> Path:
    """A backup of a service with a file that waits, whole but for what was changed in a table."""
    with stores(settings) as storage:
        ask_upload(storage, SentFile("a.json", session_bytes()), EVERYBODY, "one", NOW)
        write_backup(settings.database, storage.files, folder / "sound", NOW)
    with zipfile.ZipFile(folder / "sound") as old, zipfile.ZipFile(folder / "crafted", "w") as new:
        parts = {name: old.read(name) for name in old.namelist()}
        parts[f"tables/{table}.jsonl"] = change(parts[f"tables/{table}.jsonl"])
        manifest = json.loads(parts["manifest.json"])
        (own,) = [one for one in manifest["tables"] if one["name"] == table]
        own["sha256"] = sha256(parts[f"tables/{table}.jsonl"]).hexdigest()
        for name, content in (parts | {"manifest.json": json.dumps(manifest).encode()}).items():
            new.writestr(name, content)
    return folder / "crafted"


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (b'\\"place\\":\\"one\\"', f'\\"place\\":\\"{OUTSIDE}\\"'.encode()),
        (sha256(session_bytes()).hexdigest().encode(), b"../../precious"),
    ],
    ids=["place", "hash"],
)
def test_a_backup_that_names_a_file_elsewhere_is_not_restored(
    settings: Settings, databases: Databases, tmp_path: Path, run: Run, old: bytes, new: bytes
) -> None:
    crafted = backup_with(settings, tmp_path, "jobs", lambda lines: lines.replace(old, new))
    ran = run("restore", crafted, "--database-url", databases.empty(), "--data-folder", tmp_path / "new")
    assert ran.code == 1
    assert f"table jobs, row 1: '{OUTSIDE}' is not the name of a stored file" in ran.err
    assert not (tmp_path / "new" / "files").exists()


def test_a_job_that_names_a_file_elsewhere_removes_nothing(settings: Settings) -> None:
    with stores(settings) as storage:
        ask_upload(storage, SentFile("a.json", session_bytes()), EVERYBODY, "one", NOW)
        outside = storage.files.folder.parent / "precious"
        outside.write_text("kept")
        change = text("UPDATE jobs SET sent = CAST(REPLACE(CAST(sent AS TEXT), 'one', :name) AS JSON)")
        if storage.database.engine.dialect.name == "sqlite":
            change = text("UPDATE jobs SET sent = REPLACE(sent, '\"one\"', '\"' || :name || '\"')")
        with storage.database.engine.begin() as connection:
            connection.execute(change, {"name": OUTSIDE})
        take_in(Reception(storage, 2.0, Metrics(), lambda: None), 1, NOW)
        with storage.database.reading() as store:
            assert Jobs(store).get(1).state is JobState.FAILED
        assert outside.read_text() == "kept"
