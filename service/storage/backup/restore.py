"""Puts a backup into an empty place, of either engine: the rows in one transaction, the files under a name of their own
until all are there. Whatever interrupts it leaves a database without a schema, and it can be started again.
"""

import os
import shutil
import zipfile
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from sqlalchemy import Connection, inspect
from sqlalchemy.exc import DataError, IntegrityError

from service.errors import ConflictError, ServiceError
from service.storage.backup.doors import Doors, close_doors
from service.storage.backup.manifest import Manifest, file_member, opened
from service.storage.backup.rows import continue_numbers, put_lines, tables_of
from service.storage.backup.verify import verified
from service.storage.faults import disk_faults
from service.storage.files import Files
from service.storage.folders import make_folder, sync_folder
from service.storage.parts import written_whole
from service.storage.schema import alone, is_known, raise_to

STAGING = ".restoring"
"""Ends the name of the folder of files while they are put there."""


@dataclass(frozen=True)
class Restored:
    """What was put back."""

    manifest: Manifest
    doors: Doors


def restore(backup: Path, url: str, folder: Path, now: datetime, *, revoke_tokens: bool = False) -> Restored:
    """Restores a backup; ConflictError where the database or the folder of files is not empty."""
    manifest = verified(backup)
    if not is_known(manifest.revision):
        raise ServiceError(
            f"{backup} holds schema {manifest.revision}, which this version does not know: a newer version made it."
        )
    with alone(url) as connection, opened(backup) as archive, disk_faults():
        _require_empty(connection, folder, manifest)
        staging = _put_files(archive, manifest, folder)
        _put_rows(archive, manifest, connection)
        doors = close_doors(connection, now, revoke=revoke_tokens)
        if folder.exists():
            shutil.rmtree(folder)
        os.replace(staging, folder)
        sync_folder(folder.parent)
    return Restored(manifest, doors)


def _require_empty(connection: Connection, folder: Path, manifest: Manifest) -> None:
    """Files that are in the backup too may be left of a restore that was interrupted at its last step."""
    if inspect(connection).get_table_names():
        raise ConflictError("The database is not empty. Restore into a new one; nothing was changed.")
    found = {path.name for path in folder.rglob("*") if not path.is_dir()}
    if found - set(manifest.files):
        raise ConflictError(f"{folder} is not empty. Restore into a new folder; nothing was changed.")


def _put_files(archive: zipfile.ZipFile, manifest: Manifest, folder: Path) -> Path:
    """The uploaded files, synced, beside the place where they will stand."""
    staging = folder.with_name(folder.name + STAGING)
    if staging.exists():
        shutil.rmtree(staging)
    make_folder(staging)
    files = Files(staging)
    for digest in manifest.files:
        files.path(digest).parent.mkdir(exist_ok=True)
        with written_whole(files.path(digest)) as file, archive.open(file_member(digest)) as member:
            shutil.copyfileobj(member, file)
    for made in (*staging.iterdir(), staging):
        sync_folder(made)
    return staging


def _put_rows(archive: zipfile.ZipFile, manifest: Manifest, connection: Connection) -> None:
    """The schema as it was, and every row of it."""
    raise_to(connection, manifest.revision)
    tables = {table.name: table for table in tables_of(connection)}
    for contents in manifest.tables:
        table = tables[contents.name]
        try:
            with archive.open(contents.member) as lines:
                put_lines(connection, table, contents.columns, iter(lines))
        except (DataError, IntegrityError) as fault:
            raise ServiceError(f"Table {contents.name} cannot be put into this database: {fault.orig}") from fault
        continue_numbers(connection, table)
