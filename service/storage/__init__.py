"""Storage: the database (rows) and the files (uploaded bytes)."""

from dataclasses import dataclass

from service.storage.database import Database
from service.storage.files import Files


@dataclass(frozen=True)
class Storage:
    """Both stores of the service."""

    database: Database
    files: Files


__all__ = ["Database", "Files", "Storage"]
