"""What all queries share."""

from typing import Any

from sqlalchemy import Integer, literal_column
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.orm import Session

from service.storage.tables import Base


class Queries:
    """Queries of one subject within one transaction."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def remember_unit(self, serial: str, key: int) -> None:
        """Spares the transaction another question for a unit's key, which never changes."""
        self._session.info[serial] = key

    def remembered_unit(self, serial: str) -> int | None:
        """The key of a unit that this transaction has met."""
        return self._session.info.get(serial)

    def insert_once(self, table: type[Base], **values: Any) -> bool:
        """Inserts a row unless a unique constraint says it is there; waits for a rival that is inserting the same."""
        insert = postgresql.insert if self._session.get_bind().dialect.name == "postgresql" else sqlite.insert
        inserted = insert(table).values(**values).on_conflict_do_nothing().returning(literal_column("1", Integer))
        return self._session.scalar(inserted) is not None
