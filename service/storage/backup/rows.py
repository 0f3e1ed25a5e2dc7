"""Rows as lines with the same meaning on SQLite and on PostgreSQL, for the tables in the database."""

import base64
import json
from collections import Counter
from collections.abc import Callable, Iterator
from datetime import UTC, date, datetime
from typing import Any

from sqlalchemy import (
    JSON,
    Column,
    Connection,
    Date,
    DateTime,
    LargeBinary,
    MetaData,
    Table,
    Text,
    cast,
    func,
    select,
    text,
)
from sqlalchemy.types import UserDefinedType

BATCH = 100
"""Rows that are held at a time: the widest, the statistics of a session, have some hundred kilobytes."""
BOOKKEEPING = "alembic_version"
"""Table made by the migrations themselves."""


class _Written(UserDefinedType[str]):
    """JSON text passed to the driver unchanged."""

    cache_ok = True

    def get_col_spec(self, **_: Any) -> str:
        return "JSON"


def tables_of(connection: Connection) -> list[Table]:
    """The tables of a database; one that refers to another comes after it. Statements on them are not kept: the next
    ones have tables of their own."""
    metadata = MetaData()
    metadata.reflect(connection.execution_options(compiled_cache=None))
    return [table for table in metadata.sorted_tables if table.name != BOOKKEEPING]


def lines_of(connection: Connection, table: Table) -> Iterator[bytes]:
    """Every row, by primary key."""
    columns = [cast(c, Text).label(c.name) if isinstance(c.type, JSON) else c for c in table.columns]
    writers = [_plain(column) for column in table.columns]
    query = select(*columns).order_by(*table.primary_key.columns)
    with connection.execution_options(yield_per=BATCH).execute(query) as rows:
        for row in rows:
            values = [None if value is None else to(value) for to, value in zip(writers, row, strict=True)]
            yield json.dumps(values, ensure_ascii=False, separators=(",", ":")).encode() + b"\n"


NUL, INSTEAD = "\x00", "\ufffd"
"""The character that SQLite holds and PostgreSQL refuses, and what is stored in its place."""
NUL_WRITTEN = rb"\u0000"
"""NUL as JSON writes it."""


def put_lines(connection: Connection, table: Table, columns: tuple[str, ...], lines: Iterator[bytes]) -> Counter[str]:
    """Inserts rows into an empty table; how often a text was changed, by column, since the engine refuses NUL."""
    target_columns, changed = [table.columns[name] for name in columns], Counter[str]()
    is_sqlite = connection.dialect.name == "sqlite"
    stored = [_stored(column, naive=is_sqlite) for column in target_columns]
    for column in target_columns:
        if isinstance(column.type, JSON):
            column.type = _Written()
    batch: list[dict[str, Any]] = []
    for line in lines:
        values = json.loads(line)
        if not is_sqlite and NUL_WRITTEN in line:
            changed.update(name for name, value in zip(columns, values, strict=True) if _has_nul(value))
            values = [value.replace(NUL, INSTEAD) if _has_nul(value) else value for value in values]
        row = zip(target_columns, stored, values, strict=True)
        batch.append({c.name: None if value is None else to(value) for c, to, value in row})
        if len(batch) == BATCH:
            connection.execute(table.insert(), batch)
            batch = []
    if batch:
        connection.execute(table.insert(), batch)
    return changed


def _has_nul(value: Any) -> bool:
    return isinstance(value, str) and NUL in value


def continue_numbers(connection: Connection, table: Table) -> None:
    """Sets PostgreSQL's sequences behind the largest inserted number; SQLite does so by itself."""
    if connection.dialect.name != "postgresql":
        return
    for column in table.primary_key.columns:
        place = {"table": f'"{table.name}"', "column": column.name}
        sequence = connection.scalar(text("SELECT pg_get_serial_sequence(:table, :column)"), place)
        largest = connection.scalar(select(func.max(column))) if sequence else None
        if largest is not None:
            connection.execute(text("SELECT setval(:sequence, :largest)"), {"sequence": sequence, "largest": largest})


def _plain(column: Column[Any]) -> Callable[[Any], Any]:
    if isinstance(column.type, DateTime):
        return _instant
    if isinstance(column.type, Date):
        return date.isoformat
    if isinstance(column.type, LargeBinary):
        return lambda value: base64.b64encode(value).decode()
    return lambda value: value


def _instant(value: datetime) -> str:
    """SQLite's times are UTC without a zone."""
    return (value.replace(tzinfo=UTC) if value.tzinfo is None else value.astimezone(UTC)).isoformat()


def _stored(column: Column[Any], *, naive: bool) -> Callable[[Any], Any]:
    if isinstance(column.type, DateTime):
        return lambda value: datetime.fromisoformat(value).replace(tzinfo=None if naive else UTC)
    if isinstance(column.type, Date):
        return date.fromisoformat
    if isinstance(column.type, LargeBinary):
        return base64.b64decode
    return lambda value: value
