"""What going back to an earlier schema would take away: it is done, counted, and undone."""

from dataclasses import dataclass

from sqlalchemy import Connection, Table, func, select

from service.storage.backup.rows import tables_of
from service.storage.schema import alone, take_back


@dataclass(frozen=True)
class Loss:
    """Of one table."""

    table: str
    rows: int
    """That would be gone."""
    values: tuple[tuple[str, int], ...] = ()
    """Columns that would be gone, each with the number of rows that hold something in it."""


def losses(url: str, revision: str) -> tuple[Loss, ...]:
    """What a downgrade would delete; the database stays as it is."""
    with alone(url) as connection:
        before = {table.name: table for table in tables_of(connection)}
        rows = {name: _rows(connection, table) for name, table in before.items()}
        held = {name: _held(connection, table) for name, table in before.items()}
        take_back(connection, revision)
        after = {table.name: table for table in tables_of(connection)}
        left = {name: _rows(connection, table) for name, table in after.items()}
        connection.rollback()
    found = (_loss(name, rows[name] - left.get(name, 0), held[name], after.get(name)) for name in before)
    return tuple(loss for loss in found if loss.rows or loss.values)


def _loss(name: str, rows: int, held: dict[str, int], after: Table | None) -> Loss:
    if after is None:
        return Loss(name, rows)
    gone = ((column, number) for column, number in held.items() if column not in after.columns and number)
    return Loss(name, rows, tuple(gone))


def _rows(connection: Connection, table: Table) -> int:
    return connection.scalar(select(func.count()).select_from(table)) or 0


def _held(connection: Connection, table: Table) -> dict[str, int]:
    """For every column the number of rows that hold something in it."""
    columns = list(table.columns)
    counts = connection.execute(select(*(func.count(column) for column in columns))).one()
    return {column.name: number for column, number in zip(columns, counts, strict=True)}
