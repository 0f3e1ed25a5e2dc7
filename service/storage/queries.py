"""Common base of all queries."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from sqlalchemy import Integer, Subquery, Table, insert, literal, literal_column, select, union_all
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.orm import Session

from service.storage.tables import Base


class Store:
    """One transaction. Every subject has its queries, made from a store: ``Units(store).find(serial)``."""

    def __init__(self, session: Session, account: str = "") -> None:
        self.session, self.account = session, account


BeforeCommit = Callable[[Store], None]
"""Last step of a write transaction."""

TOUCHED = "tallied"
"""Key of the units whose counts must be updated, in the session's ``info``."""


def lists(*names: str) -> Subquery:
    """A row for each of several lists, so that short ones are read in one statement: each is joined to its row, and a
    result row holds one entry of one list."""
    return union_all(*(select(literal(name).label("list")) for name in names)).subquery("lists")


class Queries:
    """Queries of one subject within one transaction."""

    def __init__(self, store: Store) -> None:
        self._store, self._session = store, store.session

    def remember_unit(self, serial: str, key: int) -> None:
        """Caches the key of a unit, which never changes, for this transaction."""
        self._session.info["unit", serial] = key

    def remembered_unit(self, serial: str) -> int | None:
        """The cached key of a unit."""
        return self._session.info.get(("unit", serial))

    def insert_all_once(self, table: type[Base], rows: Sequence[Mapping[str, Any]]) -> None:
        """Inserts rows that do not exist yet, in one statement."""
        if rows:
            self._session.execute(self._upsert(table).on_conflict_do_nothing(), list(rows))

    def touch(self, *units: int) -> None:
        """Marks units whose counts in the fleet and use may change in this transaction."""
        self._session.info.setdefault(TOUCHED, set()).update(units)

    def touched(self) -> set[int]:
        """Returns the units touched since the last call."""
        units: set[int] = self._session.info.pop(TOUCHED, set())
        return units

    def insert_many(self, table: type[Base], rows: Sequence[Mapping[str, Any]]) -> None:
        """Inserts rows in one statement, without an object for each."""
        if rows:
            self._session.flush()
            target = table.__table__
            assert isinstance(target, Table)
            self._session.execute(insert(target), list(rows))

    def insert_once(self, table: type[Base], **values: Any) -> bool:
        """Inserts a row unless a unique constraint finds it; waits for a concurrent insert of the same."""
        inserted = self._upsert(table).values(**values).on_conflict_do_nothing()
        return self._session.scalar(inserted.returning(literal_column("1", Integer))) is not None

    def _upsert(self, table: type[Base]) -> postgresql.Insert | sqlite.Insert:
        dialect_insert = postgresql.insert if self._session.get_bind().dialect.name == "postgresql" else sqlite.insert
        return dialect_insert(table)
