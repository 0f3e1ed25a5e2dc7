"""Column types and indexes that mean the same on SQLite and PostgreSQL."""

from datetime import UTC, datetime
from typing import Any

from sqlalchemy import BigInteger, DateTime, Dialect, Integer, text
from sqlalchemy.types import TypeDecorator

RESOLVED = "resolved"
"""State of a flag that is closed."""
IS_OPEN, IS_WAITING, IS_QUESTIONED = "state <> 'resolved'", "state = 'waiting'", "state = 'questioned'"
IS_AT_WORK = "ended_at IS NULL"
IS_FAILED = "state = 'failed'"
"""Rows of flags, of deliveries, of sessions, of jobs and of diagnoses that are looked for all the time: few of many, so
each has an index of its own."""
BYTES = BigInteger().with_variant(Integer(), "sqlite")
"""Size of a file: of 2 GiB too. SQLite's integers have 64 bits anyway."""


def only_where(condition: str) -> dict[str, Any]:
    """An index of those rows only, on both engines."""
    return {"sqlite_where": text(condition), "postgresql_where": text(condition)}


class UtcDateTime(TypeDecorator[datetime]):
    """An aware time, kept and given back in UTC on every engine."""

    impl = DateTime(timezone=True)
    cache_ok = True

    def process_bind_param(self, value: datetime | None, dialect: Dialect) -> datetime | None:
        """To UTC; a naive time is a mistake of the caller."""
        if value is None:
            return None
        if value.tzinfo is None:
            raise ValueError("a time without a zone cannot be stored")
        utc = value.astimezone(UTC)
        return utc.replace(tzinfo=None) if dialect.name == "sqlite" else utc

    def process_result_value(self, value: datetime | None, dialect: Dialect) -> datetime | None:
        """Always aware, always UTC."""
        if value is None:
            return None
        return value.replace(tzinfo=UTC) if value.tzinfo is None else value.astimezone(UTC)
