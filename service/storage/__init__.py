"""What is kept: the database (rows) and the files (uploaded bytes)."""

from collections.abc import Callable
from dataclasses import dataclass

from service.settings import Settings
from service.storage.database import Database
from service.storage.files import Files, ignore
from service.storage.waits import waits_of


@dataclass(frozen=True)
class Storage:
    """Both stores of the service, as flows that write need them."""

    database: Database
    files: Files


def open_storage(settings: Settings, count: Callable[[str], None] = ignore) -> Storage:
    """The stores that the settings name; ``count`` is told of faults of files."""
    return Storage(Database(settings.database, waits_of(settings.database_seconds)), Files(settings.files, count))


__all__ = ["Database", "Files", "Storage", "open_storage"]
