"""An upload is stored whole, once, or not at all."""

import json
import sqlite3
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from datetime import UTC, datetime
from typing import Any

import pytest
from sqlalchemy import Connection, event, func, select, text

from estimator.errors import Problem
from service.diagnosis.store import Diagnoses
from service.errors import AwayError, NoSpaceError, RefusedError
from service.kit.metrics import Metrics
from service.opening import open_database
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.records.reception import Reception
from service.sessions.records import Receipt
from service.sessions.sent import SentFile
from service.sessions.store import Sessions
from service.sessions.tables import CalibrationRow, DecisionRow, ParameterRow, SessionRow
from service.settings import Settings
from service.storage import Files, Storage
from service.storage.audit import AuditRow
from service.storage.json_text import STORED
from service.units.tables import UnitRow
from service.uploads.receive import receive, receive_all, upload
from service.uploads.tables import RefusalRow
from tests.builders import arbitrary_orientations, gyro_block
from tests.databases import Databases, PostgresDatabases
from tests.service.made_sessions import session_bytes
from tests.stock import stores

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
KEPT = (UnitRow, SessionRow, CalibrationRow, ParameterRow, DecisionRow, AuditRow)


def counts(storage: Storage) -> list[int]:
    """Rows of every table that an upload writes to."""
    with storage.database.engine.connect() as connection:
        return [connection.scalar(select(func.count()).select_from(table)) or 0 for table in KEPT]


@pytest.fixture
def twin(settings: Settings) -> Iterator[Storage]:
    """A second service on the same database and folder."""
    with stores(settings) as found:
        yield found


def test_an_upload_leaves_one_row_of_everything(storage: Storage) -> None:
    upload(storage, session_bytes(), "a.json", NOW)
    assert counts(storage) == [1, 1, 1, 24, 24, 1]


def test_two_services_given_the_same_file_at_once_store_it_once(storage: Storage, twin: Storage) -> None:
    content = session_bytes()
    with ThreadPoolExecutor(8) as pool:
        futures = [pool.submit(upload, place, content, "a.json", NOW) for place in (storage, twin) * 4]
        receipts = [future.result() for future in futures]
    assert len({receipt.id for receipt in receipts}) == 1
    assert sum(receipt.created for receipt in receipts) == 1
    assert counts(storage) == [1, 1, 1, 24, 24, 1]


def test_rival_first_sessions_of_a_unit_leave_one_reference(storage: Storage, twin: Storage) -> None:
    contents = [session_bytes(seed=month, month=month) for month in range(1, 7)]
    with ThreadPoolExecutor(6) as pool:
        jobs = zip((storage, twin) * 3, contents, strict=True)
        futures = [pool.submit(upload, place, content, "a.json", NOW) for place, content in jobs]
        ids = [future.result().id for future in futures]
    with storage.database.reading() as store:
        stored = [Sessions(store).get(id) for id in ids]
    assert [one.id for one in stored if one.is_reference] == [ids[0]]
    assert sorted(one.verdict.value for one in stored) == ["pass"] * 5 + ["undecidable"]


def test_a_refusal_is_recorded_with_its_problems_and_nothing_else_is(storage: Storage) -> None:
    with pytest.raises(RefusedError) as caught:
        upload(storage, b'{"format": 1, "table": {}}', "../bad\n.json", NOW)
    with storage.database.engine.connect() as connection:
        row = connection.execute(select(RefusalRow.filename, RefusalRow.size, RefusalRow.problems)).one()
    assert (row.filename, row.size) == ("bad.json", 26)
    assert [STORED.read(Problem, p) for p in row.problems] == list(caught.value.problems)
    assert counts(storage)[:5] == [0] * 5
    assert not storage.files.folder.exists()


def test_a_unit_with_two_blocks_has_a_reference_for_each(storage: Storage) -> None:
    gyros = [json.dumps(gyro_block(seed=seed) | {"unit": "BA-017"}).encode() for seed in (1, 2)]
    files = [session_bytes(), gyros[0], session_bytes(seed=2), gyros[1]]
    ids = [upload(storage, file, "a.json", NOW).id for file in files]
    with storage.database.reading() as store:
        assert [Sessions(store).get(id).is_reference for id in ids] == [True, True, False, False]


def test_a_full_disk_under_the_database_stores_nothing_and_is_said(sqlite: Databases, tmp_path: Any) -> None:
    database = open_database(sqlite.migrated())
    storage = Storage(database, Files(tmp_path / "files"))
    with closing(sqlite3.connect(str(database.engine.url.database))) as file:
        file.execute("VACUUM")  # pages that migrations freed would be room

    def limit(connection: Any, _: Any) -> None:
        pages = connection.execute("PRAGMA page_count").fetchone()[0]
        connection.execute(f"PRAGMA max_page_count={pages + 1}")

    event.listen(database.engine, "connect", limit)
    with pytest.raises(NoSpaceError, match="disk is full"):
        upload(storage, session_bytes(), "a.json", NOW)
    assert counts(storage) == [0] * 6
    event.remove(database.engine, "connect", limit)
    database.close()
    assert upload(storage, session_bytes(), "a.json", NOW).created
    assert counts(storage) == [1, 1, 1, 24, 24, 1]
    database.close()


def test_a_database_killed_at_the_commit_leaves_nothing_and_the_upload_can_be_repeated(
    postgresql: PostgresDatabases, tmp_path: Any
) -> None:
    database = open_database(postgresql.migrated())
    storage = Storage(database, Files(tmp_path / "files"))
    other = open_database(postgresql.server.get_uri())

    def kill(connection: Connection) -> None:
        mine = connection.scalar(text("SELECT pg_backend_pid()"))
        with other.engine.connect() as admin:
            admin.execute(text("SELECT pg_terminate_backend(:pid)"), {"pid": mine})

    event.listen(database.engine, "commit", kill)
    with pytest.raises(AwayError):
        upload(storage, session_bytes(), "a.json", NOW)
    event.remove(database.engine, "commit", kill)
    assert counts(storage) == [0] * 6
    assert upload(storage, session_bytes(), "a.json", NOW).created
    database.close()
    other.close()


def test_a_reference_that_leaves_something_open_says_what_to_add(storage: Storage) -> None:
    document = arbitrary_orientations(orientations=7)
    receipt = upload(storage, json.dumps(document).encode(), "seven.json", NOW)
    assert receipt.is_reference
    assert "It does not observe scale, bias, axis of every accelerometer: add 2 still orientations" in receipt.reason


def test_a_reference_that_shows_everything_says_no_more(storage: Storage) -> None:
    assert upload(storage, session_bytes(), "a.json", NOW).reason.endswith("judged against it.")


def reception(storage: Storage, rung: list[None]) -> Reception:
    """Reception of the service; ``rung`` collects how often it rang for diagnoses."""
    return Reception(storage, 2.0, Metrics(), lambda: rung.append(None))


def test_a_received_file_is_stored_and_counted_and_its_diagnosis_asked_for(storage: Storage) -> None:
    rung: list[None] = []
    own = reception(storage, rung)
    receipt = receive(own, SentFile("a.json", session_bytes()), NOW)
    with storage.database.reading() as store:
        assert WorkQueue(store, WorkKind.DIAGNOSIS).waiting(NOW, 10) == (receipt.id,)
        assert not Diagnoses(store).exists(receipt.id)
    assert rung == [None]
    assert b'imu_health_uploads_total{result="undecidable"} 1.0' in own.metrics.text()


def test_a_file_that_cannot_be_used_keeps_no_other_out(storage: Storage) -> None:
    files = (SentFile("bad.json", b"{}"), SentFile("a.json", session_bytes()))
    received = receive_all(reception(storage, []), files, NOW)
    assert [type(one) for one in received] == [RefusedError, Receipt]
