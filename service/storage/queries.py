"""What all queries share."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from sqlalchemy import Integer, Subquery, Table, insert, literal, literal_column, select, union_all
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.orm import Session

from service.storage.tables import Base


class Store:
    """One transaction. Every subject has its queries, made of a store: ``Units(store).find(serial)``."""

    def __init__(self, session: Session, account: str = "") -> None:
        self.session, self.account = session, account


BeforeCommit = Callable[[Store], None]
"""What a transaction that writes does last."""

TOUCHED = "tallied"
"""Units whose counts are to be brought in line, in the session's own notes."""


def lists(*names: str) -> Subquery:
    """A row for each of some lists, so that short ones are read in one statement: each is joined to its row, and a
    result row holds one entry of one list."""
    return union_all(*(select(literal(name).label("list")) for name in names)).subquery("lists")


class Queries:
    """Queries of one subject within one transaction."""

    def __init__(self, store: Store) -> None:
        self._store, self._session = store, store.session

    def remember_unit(self, serial: str, key: int) -> None:
        """Spares the transaction another question for a unit's key, which never changes."""
        self._session.info["unit", serial] = key

    def remembered_unit(self, serial: str) -> int | None:
        """The key of a unit that this transaction has met."""
        return self._session.info.get(("unit", serial))

    def insert_all_once(self, table: type[Base], rows: Sequence[Mapping[str, Any]]) -> None:
        """Inserts rows in one statement, but those that are there already."""
        if rows:
            self._session.execute(self._upsert(table).on_conflict_do_nothing(), list(rows))

    def touch(self, *units: int) -> None:
        """Notes that these units may count otherwise in the fleet by the end of the transaction."""
        self._session.info.setdefault(TOUCHED, set()).update(units)

    def insert_many(self, table: type[Base], rows: Sequence[Mapping[str, Any]]) -> None:
        """Inserts rows in one statement, without an object for each."""
        if rows:
            self._session.flush()
            own = table.__table__
            assert isinstance(own, Table)
            self._session.execute(insert(own), list(rows))

    def insert_once(self, table: type[Base], **values: Any) -> bool:
        """Inserts a row unless a unique constraint says it is there; waits for a rival that is inserting the same."""
        inserted = self._upsert(table).values(**values).on_conflict_do_nothing()
        return self._session.scalar(inserted.returning(literal_column("1", Integer))) is not None

    def _upsert(self, table: type[Base]) -> postgresql.Insert | sqlite.Insert:
        """An insertion that says what becomes of rows that are there."""
        own = postgresql.insert if self._session.get_bind().dialect.name == "postgresql" else sqlite.insert
        return own(table)
