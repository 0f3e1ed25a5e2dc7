"""Writes a backup while the service runs: one read transaction sees all tables as they were at one moment, and the
files that they name are there already and never change.
"""

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
"""Level of compression: nearly as small as the best, several times as fast."""
UPLOAD = "upload"
"""Kind of the jobs whose files wait beside the uploads."""


def write_backup(url: str, files: Files, target: Path, now: datetime) -> Manifest:
    """Writes a backup that is there whole or not at all; refuses to write over a file.

    A file that a session names but that is missing or damaged is listed as lost, and the rest is written.
    """
    if target.exists():
        raise ConflictError(f"{target} is there already. A backup is never written over another file.")
    sweep(target.absolute().parent)
    with _moment(url) as connection, written_whole(target.absolute()) as file:
        revision = stored_revision(connection)
        if revision is None:
            raise ServiceError("The database holds no schema of this program, so there is nothing to write.")
        with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED, compresslevel=QUICK) as archive:
            manifest = _written(archive, connection, files, (revision, now))
    sync_folder(target.absolute().parent)
    return manifest


@contextmanager
def _moment(url: str) -> Iterator[Connection]:
    """A read transaction in which all tables stand still."""
    engine = open_engine(url, PATIENT)
    still = {} if engine.name == "sqlite" else {"isolation_level": "REPEATABLE READ", "postgresql_readonly": True}
    try:
        with database_faults(), engine.connect().execution_options(**still) as connection:
            yield connection
    finally:
        engine.dispose()


def _written(archive: zipfile.ZipFile, connection: Connection, files: Files, made: tuple[str, datetime]) -> Manifest:
    """Tables, then files, then what they are."""
    tables = tables_of(connection)
    contents = tuple(_write_table(archive, connection, table) for table in tables)
    waiting = _waiting(connection, tables)
    named = sorted(_named(connection, tables) | set(waiting))
    lost = {digest for digest in named if not _write_file(archive, files, digest, waiting.get(digest, ()))}
    manifest = Manifest(
        version=VERSION,
        revision=made[0],
        made_at=made[1],
        tables=contents,
        files=tuple(digest for digest in named if digest not in lost),
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
    """Hashes of the files that sessions were made of, and of those that were attached."""
    holding = [table for table in tables if table.name in ("sessions", "attachments")]
    return {digest for table in holding for digest in connection.scalars(select(table.columns.sha256))}


def _waiting(connection: Connection, tables: list[Table]) -> dict[str, list[str]]:
    """Hashes of files that jobs are to take in, with the places where they lie until then."""
    found = defaultdict[str, list[str]](list)
    for jobs in (table for table in tables if table.name == "jobs" and "sent" in table.columns):
        own = (jobs.columns.kind == UPLOAD, jobs.columns.ended_at.is_(None))
        for digest, sent in connection.execute(select(jobs.columns.sha256, jobs.columns.sent).where(*own)):
            found[digest].append(sent["place"])
    return found


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
