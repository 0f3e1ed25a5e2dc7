"""Statements of uploads and recomputing to the database, whatever the length of a unit's history; on both engines."""

from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime

import pytest
from sqlalchemy import Engine, event

from service.models.records import AcceptedFinding, ModelRevision, Scope
from service.models.store import Models
from service.records.recalibrate import recalibrate
from service.sessions.calibrations_store import Calibrations
from service.sessions.store import Sessions
from service.storage import Files, Storage
from service.uploads.receive import upload
from tests.databases import all_on_both_engines as pytest_generate_tests  # noqa: F401 - the hook
from tests.service.made_sessions import session_bytes

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
UNIT = "BA-017"
EVIDENCE = AcceptedFinding(1e-9, 9.0, (1e-6,), (1e-7,), ("1",), {}, (), "Found.", None)


@contextmanager
def asked() -> Iterator[list[str]]:
    """The statements of this process."""
    statements: list[str] = []

    def note(_c: object, _k: object, statement: str, *_: object) -> None:
        if not statement.startswith("BEGIN"):
            statements.append(statement)

    event.listen(Engine, "before_cursor_execute", note)
    yield statements
    event.remove(Engine, "before_cursor_execute", note)


def content(month: int) -> bytes:
    """One of a unit's sessions."""
    return session_bytes(seed=month, month=month)


def test_an_upload_asks_the_database_49_questions_at_most(storage: Storage) -> None:
    for month in (1, 2, 3):
        upload(storage, content(month), "a.json", NOW)
    with asked() as statements:
        upload(storage, content(4), "a.json", NOW)
    assert 0 < len(statements) <= 49


@pytest.mark.slow
def test_recomputing_a_unit_asks_no_more_for_more_sessions(storage: Storage) -> None:
    counts = []
    for month in (1, 2, 3, 4):
        upload(storage, content(month), "a.json", NOW)
        if month > 1:
            accept(storage, "A1" if month == 2 else "A2")
            with asked() as statements:
                assert recalibrate(storage, UNIT, NOW).recomputed == month
            counts.append(len(statements))
    assert counts[1] == counts[2]


def accept(storage: Storage, sensor: str) -> None:
    """A cause that every session of the unit is computed again for."""
    with storage.database.writing() as store:
        session = Sessions(store).of_unit(UNIT)[0].id
        own = {"subject": UNIT, "cause": "cubic-nonlinearity", "sensors": (sensor,), "session": session}
        given = {"evidence": EVIDENCE, "accepted_by": "K. Ito", "note": "", "accepted_at": NOW}
        Models(store).add(ModelRevision(id=0, scope=Scope.UNIT, **own, **given))


def test_a_session_is_judged_by_what_came_in_while_it_waited(storage: Storage) -> None:
    """It was judged against the reference of before, outside its transaction."""
    upload(storage, content(3), "a.json", NOW)
    rival = content(1)

    class Late(Files):
        def keep(self, content: bytes) -> str:  # type: ignore[override]
            upload(storage, rival, "a.json", NOW)
            return storage.files.keep(content)

    late = Late(storage.files.folder)
    found = upload(Storage(storage.database, late), content(4), "a.json", NOW)
    with storage.database.reading() as store:
        first = Sessions(store).of_unit(UNIT)[0]
        decided = Sessions(store).decisions(found.id)[0]
        known = Calibrations(store).get(first.id).sensors[0]
    assert first.is_reference
    assert (decided.parameter, decided.reference) == ("scale", known.scale.value)
