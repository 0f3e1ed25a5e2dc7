"""How often somebody tried to sign in, counted in the database: one bound for all processes together."""

from datetime import datetime, timedelta

from sqlalchemy import case, delete, update
from sqlalchemy.dialects import postgresql, sqlite

from service.storage.identity_tables import AttemptRow
from service.storage.queries.base import Queries

FORGOTTEN = timedelta(days=2)
"""After which a row is removed; long after every window, so that nobody else is at it."""


class Attempts(Queries):
    """Attempts by key; a statement that counts also tells, so that of two at once each sees its own number."""

    def count(self, key: str, window: timedelta, now: datetime) -> int:
        """Counts one more, and returns how many there were within the window that the first one opened, this one
        included."""
        insert = postgresql.insert if self._session.get_bind().dialect.name == "postgresql" else sqlite.insert
        is_over = AttemptRow.since <= now - window
        counted = insert(AttemptRow).values(key=key, since=now, count=1)
        counted = counted.on_conflict_do_update(
            index_elements=[AttemptRow.key],
            set_={
                "count": case((is_over, 1), else_=AttemptRow.count + 1),
                "since": case((is_over, now), else_=AttemptRow.since),
            },
        )
        return self._session.scalars(counted.returning(AttemptRow.count)).one()

    def take_back(self, key: str) -> None:
        """One was right after all."""
        own = AttemptRow.key == key, AttemptRow.count > 0
        self._session.execute(update(AttemptRow).where(*own).values(count=AttemptRow.count - 1))

    def forget(self, key: str) -> None:
        """All that were counted."""
        self._session.execute(update(AttemptRow).where(AttemptRow.key == key).values(count=0))

    def forget_old(self, now: datetime) -> None:
        """Rows that nobody needs."""
        self._session.execute(delete(AttemptRow).where(AttemptRow.since <= now - FORGOTTEN))
