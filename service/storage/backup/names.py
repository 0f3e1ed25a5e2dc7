"""Names in a backup's rows that become names of files when it is restored."""

import json
import zipfile
from collections.abc import Iterator
from typing import Any

from service.storage.backup.manifest import TableContents
from service.storage.folders import is_name

HASHES = "sha256"
"""The column, in any table, of the hash that a stored file is named by; empty where there is none."""
SENT = "sent"
"""The column of a file that waits, with its ``place``."""


def faulty_names(archive: zipfile.ZipFile, table: TableContents) -> Iterator[str]:
    """Every row of a table with a name that no stored file has; the table itself was found whole."""
    columns = [at for at, name in enumerate(table.columns) if name in (HASHES, SENT)]
    if not columns:
        return
    with archive.open(table.member) as lines:
        for number, line in enumerate(lines, start=1):
            values = json.loads(line)
            for at in columns:
                name = _name(table.columns[at], values[at])
                if name and not is_name(name):
                    yield f"table {table.name}, row {number}: {str(name)[:100]!r} is not the name of a stored file"


def _name(column: str, value: Any) -> Any:
    """Nothing where the row names no file."""
    if column == HASHES or value is None:
        return value
    sent = json.loads(value)
    return None if sent is None else sent.get("place")
