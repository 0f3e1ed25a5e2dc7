"""A commit that the database refuses leaves nothing behind: neither rows nor a lock."""

import pytest
from sqlalchemy import Engine, text
from sqlalchemy.exc import IntegrityError

from service.opening import open_database
from service.storage.engine import WRITES
from service.units.store import Units
from tests.databases import Databases

LATE = {
    "sqlite": ["PRAGMA defer_foreign_keys=ON"],
    "postgresql": ["ALTER TABLE note_withdrawals ALTER CONSTRAINT fk_note_withdrawals_note_id INITIALLY DEFERRED"],
}
"""Statements that make each engine check references only when the transaction is committed."""
DEFERRABLE = "ALTER TABLE note_withdrawals ALTER CONSTRAINT fk_note_withdrawals_note_id DEFERRABLE"


def refer_to_nothing(engine: Engine) -> None:
    """Writes a row that is refused when it is committed."""
    with engine.begin() as connection:
        for statement in LATE[engine.name]:
            connection.execute(text(statement))
        connection.execute(text("INSERT INTO note_withdrawals VALUES (5, '2026-01-01', 'a', 'b')"))


def test_after_a_refused_commit_the_next_user_of_the_connection_finds_no_transaction(databases: Databases) -> None:
    database = open_database(databases.migrated())
    writing = database.engine.execution_options(**{WRITES: True})
    if database.engine.name == "postgresql":
        with writing.begin() as connection:
            connection.execute(text(DEFERRABLE))
    with pytest.raises(IntegrityError):
        refer_to_nothing(writing)
    with database.writing() as store:
        assert not Units(store).exists("BA-017")
    with database.engine.connect() as connection:
        assert connection.scalar(text("SELECT count(*) FROM note_withdrawals")) == 0
    database.close()
