"""A backup holds everything, goes into either engine, and is there whole or not at all."""

import json
import os
import signal
import sqlite3
import subprocess
import sys
import zipfile
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing, suppress
from datetime import UTC, datetime
from pathlib import Path

import httpx
import pytest
from sqlalchemy import text

from service.app import create_app
from service.errors import ConflictError, DamagedError, ServiceError
from service.jobs.records import JobState
from service.jobs.store import Jobs
from service.kit.metrics import Metrics
from service.kit.person import EVERYBODY, Role
from service.opening import open_database
from service.people.changes import make_link, sign_in
from service.records.keep import keep_noise
from service.records.reception import Reception
from service.sessions.calibrations_store import SessionNoises
from service.sessions.sent import SentFile
from service.settings import Settings
from service.storage import Files, Storage
from service.storage.backup import restore, verified, write_backup
from service.storage.schema import upgrade
from service.uploads.receive import upload
from service.uploads.take_in import ask_upload, take_in
from tests.builders import raw_log
from tests.conftest import SettingsFilled
from tests.databases import ENGINES, Databases, one_engine
from tests.service.made_sessions import FAILED, session_bytes
from tests.service.people.staff import PASSWORD, staffed
from tests.service.storage.whole import files, rows
from tests.serving import http_client
from tests.stock import stores

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
Killed = Callable[..., bool]


def fill(settings: Settings) -> None:
    """Flags, notes, a certificate's customer and a refusal."""
    with http_client(create_app(settings)) as client:
        for content in (*FAILED, b"{}"):
            client.post("/api/v1/sessions", content=content)
        note(client, "dropped; Ω ≠ 0")
        client.put("/api/v1/units/BA-017/customer", json={"name": "Aero", "address": "Derby"}).raise_for_status()


@pytest.fixture
def full(settings_filled: SettingsFilled) -> Settings:
    return settings_filled(fill)


across = pytest.mark.parametrize(("databases", "other"), [ENGINES, ENGINES[::-1]], indirect=True)
"""Runs from either engine into the other."""


@pytest.fixture
def other(request: pytest.FixtureRequest) -> Databases:
    """Databases of the engine to restore into."""
    found: Databases = request.getfixturevalue(request.param)
    return found


def note(client: httpx.Client, words: str) -> None:
    """Writes something with a number of its own."""
    client.post("/api/v1/units/BA-017/notes", json={"text": words, "by": "K. Ito"}).raise_for_status()


def backup_of(settings: Settings, folder: Path) -> Path:
    """A backup of a service."""
    write_backup(settings.database, Files(settings.files), folder / "all.backup", NOW)
    return folder / "all.backup"


@pytest.mark.parametrize("other", ENGINES, indirect=True)
def test_a_backup_restores_everything_into_either_engine(full: Settings, other: Databases, tmp_path: Path) -> None:
    url = other.empty()
    restore(backup_of(full, tmp_path), url, tmp_path / "new" / "files", NOW)
    assert rows(url) == rows(full.database)
    assert files(tmp_path / "new") == files(full.files) != {}


@pytest.mark.parametrize(("databases", "other"), [ENGINES], indirect=True)
def test_a_text_that_the_other_engine_refuses_is_said_and_the_rest_restored(
    full: Settings, other: Databases, tmp_path: Path
) -> None:
    with closing(sqlite3.connect(full.database.removeprefix("sqlite:///"))) as connection:
        connection.execute("UPDATE unit_types SET name = 'a' || char(0)")
        connection.commit()
    new = Settings(database_url=other.empty(), data_folder=tmp_path / "new")
    restored = restore(backup_of(full, tmp_path), new.database, new.files, NOW)
    assert restored.changed == {"unit_types.name": 1}
    assert {row[1] for row in rows(new.database)["unit_types"]} == {"a\ufffd"}
    assert len(rows(new.database)["sessions"]) == len(rows(full.database)["sessions"]) > 0


@pytest.mark.slow
@across
def test_noise_at_rest_is_restored_into_either_engine(
    storage: Storage, settings: Settings, other: Databases, tmp_path: Path
) -> None:
    id = upload(storage, json.dumps(raw_log(orientations=8)).encode(), "log.json", NOW).id
    keep_noise(storage, id, NOW)
    new = Settings(database_url=other.empty(), data_folder=tmp_path / "new")
    restore(backup_of(settings, tmp_path), new.database, new.files, NOW)
    assert rows(new.database)["session_noise"] == rows(settings.database)["session_noise"] != []
    with stores(new) as restored, restored.database.reading() as store:
        found = SessionNoises(store).get(id)
    assert found is not None
    assert (found.rests, [sensor.name for sensor in found.sensors]) == (8, ["A1", "A2", "A3"])


@across
def test_a_restored_service_goes_on(full: Settings, other: Databases, tmp_path: Path) -> None:
    new = Settings(database_url=other.empty(), data_folder=tmp_path / "new")
    restore(backup_of(full, tmp_path), new.database, new.files, NOW)
    with http_client(create_app(new)) as client:
        note(client, "after restoring")
        assert client.post("/api/v1/sessions", content=FAILED[0]).status_code == 200
        assert client.post("/api/v1/sessions", content=session_bytes(seed=9, month=6)).status_code == 201


@pytest.mark.slow
def test_a_backup_of_an_earlier_schema_is_restored_as_it_was(databases: Databases, tmp_path: Path) -> None:
    old, new = databases.empty(), databases.empty()
    upgrade(old, "0003")
    write_backup(old, Files(tmp_path / "files"), tmp_path / "old", NOW)
    assert restore(tmp_path / "old", new, tmp_path / "new", NOW).manifest.revision == "0003"
    upgrade(new)
    assert rows(new) == {name: [] for name in rows(new)}


@pytest.mark.slow
def test_what_is_uploaded_meanwhile_is_wholly_in_it_or_not_at_all(full: Settings, tmp_path: Path) -> None:
    meanwhile = [session_bytes(seed=seed, month=seed - 46) for seed in (50, 51)]
    with http_client(create_app(full)) as client, ThreadPoolExecutor(1) as uploading:
        answers = [uploading.submit(client.post, "/api/v1/sessions", content=content) for content in meanwhile]
        number = 0
        while not all(answer.done() for answer in answers):
            manifest = write_backup(full.database, Files(full.files), tmp_path / str(number), NOW)
            sizes = {table.name: table.rows for table in manifest.tables}
            assert (sizes["sessions"], manifest.lost) == (len(manifest.files), ())
            assert sizes["sessions"] == sizes["calibrations"]
            number += 1
    assert [answer.result().status_code for answer in answers] == [201] * 2


def test_nothing_is_restored_over_what_is_there(full: Settings, databases: Databases, tmp_path: Path) -> None:
    backup, before = backup_of(full, tmp_path), rows(full.database)
    with pytest.raises(ConflictError, match="database is not empty"):
        restore(backup, full.database, tmp_path / "new", NOW)
    with pytest.raises(ConflictError, match="never written over"):
        backup_of(full, tmp_path)
    Files(tmp_path / "held").keep(b"something else")
    with pytest.raises(ConflictError, match="held is not empty"):
        restore(backup, databases.empty(), tmp_path / "held", NOW)
    assert rows(full.database) == before


def inside_a_file(backup: Path, content: bytes, share: float) -> int:
    """Place of a byte of the largest member's data; some bytes between members, such as their times, mean nothing."""
    backup.write_bytes(content)
    with zipfile.ZipFile(backup) as archive:
        largest = max(archive.infolist(), key=lambda info: info.compress_size)
    return largest.header_offset + 30 + len(largest.filename) + int(share * largest.compress_size)


@one_engine
@pytest.mark.parametrize("share", [0.2, 0.5, 0.9, 0.999])
def test_a_backup_that_was_cut_off_or_changed_is_refused(full: Settings, tmp_path: Path, share: float) -> None:
    backup = backup_of(full, tmp_path)
    content = backup.read_bytes()
    backup.write_bytes(content[: int(share * len(content))])
    with pytest.raises(ServiceError, match="cut off"):
        verified(backup)
    place = inside_a_file(backup, content, share)
    backup.write_bytes(content[:place] + bytes([content[place] ^ 1]) + content[place + 1 :])
    with pytest.raises(ServiceError):
        verified(backup)


@pytest.mark.slow
@one_engine
def test_no_byte_of_its_manifest_and_index_changes_without_an_answer(full: Settings, tmp_path: Path) -> None:
    backup = backup_of(full, tmp_path)
    content = backup.read_bytes()
    for place in range(len(content) - 3000, len(content), 13):
        backup.write_bytes(content[:place] + bytes([content[place] ^ 128]) + content[place + 1 :])
        with suppress(ServiceError):
            verified(backup)


@pytest.mark.slow
@one_engine
@pytest.mark.parametrize("place", [6, 8, 10], ids=["version", "flags", "packing"])
@pytest.mark.parametrize("bit", [1, 64])
def test_no_bit_of_how_a_member_is_packed_ends_in_a_fault(full: Settings, tmp_path: Path, place: int, bit: int) -> None:
    """The places in an entry of the index (APPNOTE 4.3.12); one bit of the flags says that the member is encrypted."""
    backup = backup_of(full, tmp_path)
    content = bytearray(backup.read_bytes())
    content[content.index(b"PK\x01\x02") + place] ^= bit
    backup.write_bytes(content)
    with suppress(ServiceError):
        verified(backup)


@one_engine
@pytest.mark.parametrize("member", ["tables/sessions.jsonl", "files/"])
def test_a_part_that_was_replaced_is_named(full: Settings, tmp_path: Path, member: str) -> None:
    backup = backup_of(full, tmp_path)
    with zipfile.ZipFile(backup) as old, zipfile.ZipFile(tmp_path / "forged", "w") as new:
        for name in old.namelist():
            new.writestr(name, b"forged" if name.startswith(member) else old.read(name))
    with pytest.raises(DamagedError, match="changed or is missing"):
        verified(tmp_path / "forged")


@one_engine
def test_a_lost_file_is_told_and_the_rest_is_kept(full: Settings, tmp_path: Path) -> None:
    whole = Files(full.files)
    digest = min(files(full.files))
    whole.path(digest).write_bytes(b"changed")
    manifest = write_backup(full.database, whole, tmp_path / "all.backup", NOW)
    assert (manifest.lost, len(manifest.files)) == ((digest,), 1)
    assert verified(tmp_path / "all.backup") == manifest


def test_a_restore_that_fails_leaves_a_database_without_a_schema(
    full: Settings, databases: Databases, tmp_path: Path
) -> None:
    url, backup = databases.empty(), backup_of(full, tmp_path)
    (tmp_path / "place").write_text("no folder can be here")
    with pytest.raises(ServiceError):
        restore(backup, url, tmp_path / "place" / "files", NOW)
    database = open_database(url)
    with pytest.raises(ServiceError, match="is at nothing"):
        database.require_ready()
    database.close()


FORKS = """
import json, multiprocessing, os, signal, sys
from datetime import UTC, datetime
from pathlib import Path
from service.storage import Files
from service.storage.backup import restore, write_backup
PLACES = ("backup/write.py", "backup/restore.py", "backup/rows.py", "storage/files.py", "storage/parts.py")

def work(call, what, url, folder, backup):
    left = call
    def look(frame, event, argument):
        nonlocal left
        if event == "call" and frame.f_code.co_filename.endswith(PLACES):
            left -= 1
            if not left:
                os.kill(os.getpid(), signal.SIGKILL)
    sys.setprofile(look)
    if what == "backup":
        write_backup(url, Files(Path(folder)), Path(backup), datetime.now(UTC))
    else:
        restore(Path(backup), url, Path(folder), datetime.now(UTC))

fork = multiprocessing.get_context("fork")
for line in sys.stdin:
    process = fork.Process(target=work, args=json.loads(line))
    process.start()
    process.join()
    print(process.exitcode, flush=True)
"""
"""A process for every line, which ends itself as `kill -9` does, at the n-th call of a function of the backup."""


@pytest.fixture(scope="module")
def killed_at() -> Iterator[Killed]:
    """Function that tells whether a backup or a restore is killed at a call, or done before."""
    command = [sys.executable, "-c", FORKS]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as forks:
        asked, told = forks.stdin, forks.stdout
        assert asked is not None
        assert told is not None

        def killed(call: int, what: str, *where: object) -> bool:
            print(json.dumps([call, what, *map(str, where)]), file=asked, flush=True)
            code = int(told.readline())
            assert code in (0, -signal.SIGKILL)
            return code != 0

        yield killed


CALLS = (2, 1000, 1950)
"""Calls at the beginning, on the way and near the end: restoring so little takes 1971 calls, writing it 2390."""


@pytest.mark.slow
@pytest.mark.parametrize("call", CALLS)
def test_a_backup_that_is_killed_leaves_nothing_that_looks_whole(
    full: Settings, killed_at: Killed, tmp_path: Path, call: int
) -> None:
    target = tmp_path / "all.backup"
    assert killed_at(call, "backup", full.database, full.files, target) != target.exists()
    for rest in tmp_path.glob(".part-*"):
        os.utime(rest, (0, 0))
    write_backup(full.database, Files(full.files), tmp_path / "again.backup", NOW)
    assert not list(tmp_path.glob(".part-*"))


@pytest.mark.slow
@pytest.mark.parametrize("call", CALLS)
def test_a_restore_that_is_killed_leaves_no_schema_and_can_be_started_again(
    full: Settings, databases: Databases, killed_at: Killed, tmp_path: Path, call: int
) -> None:
    url, backup, folder = databases.empty(), backup_of(full, tmp_path), tmp_path / "new" / "files"
    if killed_at(call, "restore", url, folder, backup):
        database = open_database(url)
        with database.engine.connect() as connection:
            assert connection.dialect.get_table_names(connection) == []
        database.close()
        restore(backup, url, folder, NOW)
    assert rows(url) == rows(full.database)
    assert files(folder) == files(full.files)


def test_a_new_schema_holds_no_rows_that_a_restore_would_meet(databases: Databases) -> None:
    assert {name for name, found in rows(databases.migrated()).items() if found} == set()


@pytest.mark.slow
@across
def test_numbers_go_on_after_the_largest(full: Settings, other: Databases, tmp_path: Path) -> None:
    url = other.empty()
    restore(backup_of(full, tmp_path), url, tmp_path / "new", NOW)
    database = open_database(url)
    with database.engine.begin() as connection:
        insert = "INSERT INTO audit (at, who, action, subject, details) VALUES (:at, 'a', 'b', 'c', '{}') RETURNING id"
        assert connection.scalar(text(insert), {"at": "2026-01-01 00:00:00"}) == len(rows(full.database)["audit"]) + 1
    database.close()


@pytest.mark.slow
@across
def test_nobody_is_signed_in_after_a_restore_and_tokens_are_told(
    settings: Settings, storage: Storage, other: Databases, tmp_path: Path
) -> None:
    staff = staffed(storage, NOW, signing=("crew",))
    secret, link = sign_in(storage, "crew", PASSWORD, NOW), make_link(storage, "viewer", NOW, "test")
    for revoke, status in ((False, 200), (True, 401)):
        new = Settings(database_url=other.empty(), data_folder=tmp_path / str(revoke), sign_in="required")
        doors = restore(
            _backup(settings, tmp_path, str(revoke)), new.database, new.files, NOW, revoke_tokens=revoke
        ).access
        assert (doors.browsers, doors.tokens, doors.revoked) == (2, 4, revoke)
        with http_client(create_app(new, clock=lambda: NOW)) as client:
            units = "/api/v1/units"
            assert client.get(units, headers=staff.headers(Role.VIEWER)).status_code == status
            assert client.get(units, headers={"Cookie": f"imu-health={secret}"}).status_code == 401
            assert client.get(f"/sign-in/{link}").status_code == 401


def _backup(settings: Settings, folder: Path, name: str) -> Path:
    write_backup(settings.database, Files(settings.files), folder / f"{name}.backup", NOW)
    return folder / f"{name}.backup"


@pytest.mark.slow
@one_engine
def test_a_large_file_that_waits_to_be_read_is_restored_with_its_job(
    settings: Settings, databases: Databases, tmp_path: Path
) -> None:
    with stores(settings) as storage:
        ask_upload(storage, SentFile("a.json", session_bytes()), EVERYBODY, "one", NOW)
        manifest = write_backup(settings.database, storage.files, tmp_path / "b.zip", NOW)
    other = Settings(database_url=databases.empty(), data_folder=tmp_path / "other")
    restore(tmp_path / "b.zip", other.database, other.files, NOW)
    with stores(other) as storage:
        take_in(Reception(storage, 2.0, Metrics(), lambda: None), 1, NOW)
        with storage.database.reading() as store:
            assert Jobs(store).get(1).state is JobState.DONE
    assert (len(manifest.files), manifest.lost) == (1, ())
