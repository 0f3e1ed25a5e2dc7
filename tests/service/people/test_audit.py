"""The audit trail is a chain: what is changed, left out or put in between shows."""

from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest
from sqlalchemy import Connection, text

from service.storage import Storage
from service.storage.audit import Audit
from tests.service.people.staff import NOW


def write(storage: Storage, *subjects: str) -> None:
    """A transaction for each line."""
    for subject in subjects:
        with storage.database.acting("k.ito").writing() as store:
            Audit(store).write(NOW, "K. Ito", "note", subject, {"text": "ü", "size": 1e22, "none": None})


def broken(storage: Storage) -> int | None:
    with storage.database.reading() as store:
        return Audit(store).check().broken


def tampered(storage: Storage, statement: str) -> None:
    """Executes a statement as somebody would who may do everything to the database."""
    with storage.database.engine.begin() as connection:
        _unguard(connection)
        connection.execute(text(statement))


def _unguard(connection: Connection) -> None:
    if connection.dialect.name == "postgresql":
        connection.execute(text("DROP TRIGGER audit_append_only ON audit"))
    else:
        for action in ("update", "delete"):
            connection.execute(text(f"DROP TRIGGER audit_no_{action}"))


def test_a_hash_that_was_noted_is_still_there(storage: Storage) -> None:
    write(storage, "a", "b")
    with storage.database.reading() as store:
        audit = Audit(store)
        noted = audit.page(2)[1].hash
        assert [audit.check(hash).expected for hash in (noted, "0" * 64, "")] == [True, False, None]


def test_a_whole_trail_is_whole(storage: Storage) -> None:
    write(storage, "a", "b", "c")
    with storage.database.reading() as store:
        check, lines = Audit(store).check(), Audit(store).page(10)
    assert (check.lines, check.broken, check.last) == (3, None, lines[0].hash)
    assert [(line.subject, line.account) for line in lines] == [("c", "k.ito"), ("b", "k.ito"), ("a", "k.ito")]


@pytest.mark.parametrize(
    ("statement", "number"),
    [
        ("UPDATE audit SET who = 'nobody' WHERE id = 2", 2),
        ("DELETE FROM audit WHERE id = 2", 3),
        ("UPDATE audit SET account = '' WHERE id = 1", 1),
        ("UPDATE audit SET hash = (SELECT hash FROM audit WHERE id = 1) WHERE id = 2", 2),
    ],
)
def test_a_changed_trail_names_the_line(storage: Storage, statement: str, number: int) -> None:
    write(storage, "a", "b", "c")
    tampered(storage, statement)
    assert broken(storage) == number


def test_lines_that_were_cut_off_show_by_the_last_hash(storage: Storage) -> None:
    write(storage, "a", "b")
    with storage.database.reading() as store:
        before = Audit(store).check().last
    tampered(storage, "DELETE FROM audit WHERE id = 2")
    with storage.database.reading() as store:
        assert Audit(store).check().last != before


def test_writers_at_once_make_one_chain(storage: Storage) -> None:
    with ThreadPoolExecutor(6) as pool:
        list(pool.map(lambda k: write(storage, *(f"{k}-{n}" for n in range(5))), range(6)))
    with storage.database.reading() as store:
        assert (Audit(store).check().lines, Audit(store).check().broken) == (30, None)


def test_what_is_undone_leaves_no_line(storage: Storage) -> None:
    def failing() -> Any:
        with storage.database.writing() as store:
            Audit(store).write(NOW, "K. Ito", "note", "a", {})
            raise RuntimeError

    with pytest.raises(RuntimeError):
        failing()
    with storage.database.reading() as store:
        assert Audit(store).check().lines == 0
