"""Restores a backup into an empty place, on either engine: the rows in one transaction, the files under a temporary
name until all are there. An interrupted restore leaves a database without a schema, and can be repeated."""

import os
import shutil
import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from datetime import datetime
from hashlib import sha256
from pathlib import Path

from sqlalchemy import Connection, inspect
from sqlalchemy.exc import DataError, IntegrityError

from service.errors import ConflictError, DamagedError, ServiceError
from service.storage.backup.manifest import (
    UNREADABLE,
    Manifest,
    RevokedAccess,
    TableContents,
    faulty_names,
    file_member,
    opened,
    read_manifest,
    revoke_access,
)
from service.storage.backup.rows import continue_numbers, put_lines, tables_of
from service.storage.faults import disk_faults
from service.storage.files import Files
from service.storage.folders import make_folder, sync_folder, written_whole
from service.storage.schema import alone, is_known, raise_to

STAGING = ".restoring"
"""Suffix of the folder of files until all are there."""


@dataclass(frozen=True)
class Restored:
    """Result of a restore."""

    manifest: Manifest
    access: RevokedAccess
    changed: Mapping[str, int]
    """How many texts held a NUL, which the database refuses, by table and column."""


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
        changed = _put_rows(archive, manifest, connection)
        access = revoke_access(connection, now, revoke=revoke_tokens)
        if folder.exists():
            shutil.rmtree(folder)
        os.replace(staging, folder)
        sync_folder(folder.parent)
    return Restored(manifest, access, changed)


def _require_empty(connection: Connection, folder: Path, manifest: Manifest) -> None:
    """Files that are in the backup too may be left by a restore that was interrupted at its last step."""
    if inspect(connection).get_table_names():
        raise ConflictError("The database is not empty. Restore into a new one; nothing was changed.")
    names = {path.name for path in folder.rglob("*") if not path.is_dir()}
    if names - set(manifest.files):
        raise ConflictError(f"{folder} is not empty. Restore into a new folder; nothing was changed.")


def _put_files(archive: zipfile.ZipFile, manifest: Manifest, folder: Path) -> Path:
    """The uploaded files, synced, next to their final place."""
    staging = folder.with_name(folder.name + STAGING)
    if staging.exists():
        shutil.rmtree(staging)
    make_folder(staging)
    files = Files(staging)
    for digest in manifest.files:
        files.path(digest).parent.mkdir(exist_ok=True)
        with written_whole(files.path(digest)) as file, archive.open(file_member(digest)) as member:
            shutil.copyfileobj(member, file)
    for folder_made in (*staging.iterdir(), staging):
        sync_folder(folder_made)
    return staging


def _put_rows(archive: zipfile.ZipFile, manifest: Manifest, connection: Connection) -> dict[str, int]:
    """The schema at its revision, and every row; how many texts were changed, by table and column."""
    changed: dict[str, int] = {}
    raise_to(connection, manifest.revision)
    tables = {table.name: table for table in tables_of(connection)}
    for contents in manifest.tables:
        table = tables[contents.name]
        try:
            with archive.open(contents.member) as lines:
                found = put_lines(connection, table, contents.columns, iter(lines))
        except (DataError, IntegrityError) as fault:
            raise ServiceError(f"Table {contents.name} cannot be put into this database: {fault.orig}") from fault
        changed |= {f"{table.name}.{column}": count for column, count in found.items()}
        continue_numbers(connection, table)
    return changed


def verified(file: Path) -> Manifest:
    """The manifest of a verified backup; DamagedError with every damaged part."""
    with opened(file) as archive:
        manifest = read_manifest(archive)
        faults = list(_faults(archive, manifest))
    if faults:
        raise DamagedError(f"{file} is damaged: {'; '.join(faults)}.")
    return manifest


def _faults(archive: zipfile.ZipFile, manifest: Manifest) -> Iterator[str]:
    yield from (f"{name} does not belong to it" for name in sorted(set(archive.namelist()) - manifest.members))
    for table in manifest.tables:
        if not _is_table(archive, table):
            yield f"table {table.name} was changed or is missing"
        else:
            yield from faulty_names(archive, table)
    for digest in manifest.files:
        if not _is_file(archive, digest):
            yield f"file {digest} was changed or is missing"


CHUNK = 1024 * 1024
"""Bytes of a file that are held at a time."""


def _is_table(archive: zipfile.ZipFile, table: TableContents) -> bool:
    hashed, rows = sha256(), 0
    try:
        with archive.open(table.member) as lines:
            for line in lines:
                hashed.update(line)
                rows += 1
    except UNREADABLE:
        return False
    return (hashed.hexdigest(), rows) == (table.sha256, table.rows)


def _is_file(archive: zipfile.ZipFile, digest: str) -> bool:
    try:
        with archive.open(file_member(digest)) as member:
            hashed = sha256()
            while chunk := member.read(CHUNK):
                hashed.update(chunk)
            return hashed.hexdigest() == digest
    except UNREADABLE:
        return False
