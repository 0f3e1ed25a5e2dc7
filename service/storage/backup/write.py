"""Writes a backup while the service runs: one read transaction sees all tables at one moment; the files that they name
exist already and never change."""

import zipfile
from collections import defaultdict
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from datetime import datetime
from hashlib import sha256
from pathlib import Path

from sqlalchemy import Connection, Table, select

from service.errors import ConflictError, ServiceError
from service.settings import VERSION
from service.storage.backup.manifest import Manifest, TableContents, file_member, member_to_write, write_manifest
from service.storage.backup.rows import lines_of, tables_of
from service.storage.engine import open_engine
from service.storage.faults import database_faults
from service.storage.files import LOST, Files
from service.storage.folders import sweep, sync_folder, written_whole
from service.storage.schema import stored_revision
from service.storage.waiting import whole_file
from service.storage.waits import PATIENT

QUICK = 1
"""Compression level: nearly as small as the best, several times as fast."""
UPLOAD = "upload"
"""Kind of the jobs whose files wait next to the uploads."""


def write_backup(url: str, files: Files, target: Path, now: datetime) -> Manifest:
    """Writes a backup completely or not at all; refuses to overwrite a file.

    A file that a session names but that is missing or damaged is listed as lost, and the rest is written.
    """
    if target.exists():
        raise ConflictError(f"{target} is there already. A backup is never written over another file.")
    sweep(target.absolute().parent)
    with _snapshot(url) as connection, written_whole(target.absolute()) as file:
        revision = stored_revision(connection)
        if revision is None:
            raise ServiceError("The database holds no schema of this program, so there is nothing to write.")
        with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED, compresslevel=QUICK) as archive:
            manifest = _written(archive, connection, files, (revision, now))
    sync_folder(target.absolute().parent)
    return manifest


@contextmanager
def _snapshot(url: str) -> Iterator[Connection]:
    engine = open_engine(url, PATIENT)
    options = {} if engine.name == "sqlite" else {"isolation_level": "REPEATABLE READ", "postgresql_readonly": True}
    try:
        with database_faults(), engine.connect().execution_options(**options) as connection:
            yield connection
    finally:
        engine.dispose()


def _written(archive: zipfile.ZipFile, connection: Connection, files: Files, stamp: tuple[str, datetime]) -> Manifest:
    tables = tables_of(connection)
    contents = tuple(_write_table(archive, connection, table) for table in tables)
    waiting = _waiting(connection, tables)
    digests = sorted(_named(connection, tables) | set(waiting))
    lost = {digest for digest in digests if not _write_file(archive, files, digest, waiting.get(digest, ()))}
    manifest = Manifest(
        version=VERSION,
        revision=stamp[0],
        made_at=stamp[1],
        tables=contents,
        files=tuple(digest for digest in digests if digest not in lost),
        lost=tuple(sorted(lost)),
    )
    write_manifest(archive, manifest)
    return manifest


def _write_table(archive: zipfile.ZipFile, connection: Connection, table: Table) -> TableContents:
    hashed, rows = sha256(), 0
    with member_to_write(archive, f"tables/{table.name}.jsonl") as member:
        for line in lines_of(connection, table):
            hashed.update(line)
            member.write(line)
            rows += 1
    names = tuple(column.name for column in table.columns)
    return TableContents(name=table.name, columns=names, rows=rows, sha256=hashed.hexdigest())


def _named(connection: Connection, tables: list[Table]) -> set[str]:
    """Hashes of the files of sessions and attachments."""
    file_tables = [table for table in tables if table.name in ("sessions", "attachments")]
    return {digest for table in file_tables for digest in connection.scalars(select(table.columns.sha256))}


def _waiting(connection: Connection, tables: list[Table]) -> dict[str, list[str]]:
    """Hashes of files that jobs will process, with the places where they are stored until then."""
    places = defaultdict[str, list[str]](list)
    for jobs in (table for table in tables if table.name == "jobs" and "sent" in table.columns):
        conditions = (jobs.columns.kind == UPLOAD, jobs.columns.ended_at.is_(None))
        for digest, sent in connection.execute(select(jobs.columns.sha256, jobs.columns.sent).where(*conditions)):
            places[digest].append(sent["place"])
    return places


def _write_file(archive: zipfile.ZipFile, files: Files, digest: str, places: Sequence[str]) -> bool:
    """Whether the file was there as it was uploaded."""
    try:
        content = whole_file(files, digest, places) if places else files.content(digest)
    except LOST:
        return False
    if isinstance(content, bytes):
        archive.writestr(file_member(digest), content)
    else:
        archive.write(content, file_member(digest))
    return True
