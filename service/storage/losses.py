"""Losses by a downgrade to an earlier schema: it is done, counted, and rolled back."""

from dataclasses import dataclass

from sqlalchemy import Connection, Table, func, select

from service.storage.backup.rows import tables_of
from service.storage.schema import alone, take_back


@dataclass(frozen=True)
class Loss:
    """Loss of one table."""

    table: str
    rows: int
    values: tuple[tuple[str, int], ...] = ()
    """Deleted columns, each with the number of rows that have a value in it."""


def losses(url: str, revision: str) -> tuple[Loss, ...]:
    """The rows and values that a downgrade would delete; the database stays as it is."""
    with alone(url) as connection:
        before = {table.name: table for table in tables_of(connection)}
        rows = {name: _rows(connection, table) for name, table in before.items()}
        filled = {name: _filled(connection, table) for name, table in before.items()}
        take_back(connection, revision)
        after = {table.name: table for table in tables_of(connection)}
        remaining = {name: _rows(connection, table) for name, table in after.items()}
        connection.rollback()
    lost = (_loss(name, rows[name] - remaining.get(name, 0), filled[name], after.get(name)) for name in before)
    return tuple(loss for loss in lost if loss.rows or loss.values)


def _loss(name: str, rows: int, filled: dict[str, int], after: Table | None) -> Loss:
    if after is None:
        return Loss(name, rows)
    columns = ((column, number) for column, number in filled.items() if column not in after.columns and number)
    return Loss(name, rows, tuple(columns))


def _rows(connection: Connection, table: Table) -> int:
    return connection.scalar(select(func.count()).select_from(table)) or 0


def _filled(connection: Connection, table: Table) -> dict[str, int]:
    columns = list(table.columns)
    counts = connection.execute(select(*(func.count(column) for column in columns))).one()
    return {column.name: number for column, number in zip(columns, counts, strict=True)}
