"""The whole state of a service, read through the tables that the program knows: for comparing two of them."""

from pathlib import Path
from typing import Any

from sqlalchemy import select

from service.opening import open_database
from service.storage.tables import Base
from service.storage.waiting import FOLDER


def rows(url: str) -> dict[str, list[tuple[Any, ...]]]:
    """Every row of every table, by primary key."""
    database = open_database(url)
    with database.engine.connect() as connection:
        found = {
            table.name: [tuple(row) for row in connection.execute(select(table).order_by(*table.primary_key.columns))]
            for table in Base.metadata.sorted_tables
        }
    database.close()
    return found


def files(folder: Path) -> dict[str, bytes]:
    """Every uploaded file; what was received and not yet read is none."""
    found = (path for path in folder.rglob("*") if path.is_file() and path.parent.name != FOLDER)
    return {path.name: path.read_bytes() for path in found}
