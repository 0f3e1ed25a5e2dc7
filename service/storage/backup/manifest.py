"""What a backup says of itself, and the names within it.

A backup is a zip file. Its table of contents stands at its end, so one that was cut off cannot be opened; the manifest
is written last.

    tables/NAME.jsonl   a line a row: the values in the order of the manifest's columns
    files/SHA256        an uploaded file under its hash
    manifest.json       this
"""

import json
import zipfile
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import IO, Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, StringConstraints, ValidationError
from sqlalchemy import Connection, delete, func, inspect, select, update

from service.errors import ServiceError
from service.people.tables import AttemptRow, SignInLinkRow, SignInRow, TokenRow
from service.storage.folders import is_name

MANIFEST = "manifest.json"
HASH = "^[0-9a-f]{64}$"
UNREADABLE = (
    zipfile.BadZipFile,  # a broken header
    zlib.error,  # a broken stream
    OSError,  # a place before the beginning
    EOFError,  # its end comes too soon
    KeyError,  # a member is missing
    RuntimeError,  # a member that claims to be encrypted, or packed in a way that a changed byte made up
)
"""What reading a changed backup ends in."""


Hash = Annotated[str, StringConstraints(pattern=HASH)]


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class TableContents(_Part):
    """One table."""

    name: str = Field(pattern="^[a-z_0-9]+$")
    columns: tuple[str, ...]
    rows: int = Field(ge=0)
    sha256: str = Field(pattern=HASH)
    """Of the lines."""

    @property
    def member(self) -> str:
        """Its name in the backup."""
        return f"tables/{self.name}.jsonl"


class Manifest(_Part):
    """What a backup holds."""

    format: Literal["imu-backup/1"] = "imu-backup/1"
    version: str
    """Of the program that wrote it."""
    revision: str
    """Of the schema."""
    made_at: datetime
    tables: tuple[TableContents, ...]
    """In an order in which rows can be put in: what is referred to comes first."""
    files: tuple[Hash, ...]
    """Hashes of the uploaded files."""
    lost: tuple[str, ...]
    """Hashes of files that sessions name, but that were missing or damaged when the backup was made."""

    @property
    def members(self) -> set[str]:
        """Every name in the backup."""
        return {MANIFEST, *(table.member for table in self.tables), *map(file_member, self.files)}


def file_member(digest: str) -> str:
    """The name of an uploaded file in the backup."""
    return f"files/{digest}"


def opened(file: Path) -> zipfile.ZipFile:
    """A backup to read; ServiceError where it is none, or is not whole."""
    try:
        return zipfile.ZipFile(file)
    except (FileNotFoundError, PermissionError):
        raise
    except UNREADABLE as fault:
        raise ServiceError(f"{file} is not a backup, or was cut off: {fault}.") from fault


def read_manifest(archive: zipfile.ZipFile) -> Manifest:
    """What the backup says of itself; ServiceError where it says nothing that this version understands."""
    try:
        manifest = Manifest.model_validate_json(archive.read(MANIFEST))
    except (*UNREADABLE, ValidationError) as fault:
        raise ServiceError(f"{archive.filename} is no backup that this version understands.") from fault
    return manifest


def write_manifest(archive: zipfile.ZipFile, manifest: Manifest) -> None:
    """Closes the contents of a backup."""
    archive.writestr(MANIFEST, manifest.model_dump_json(indent=1))


def member_to_write(archive: zipfile.ZipFile, name: str) -> IO[bytes]:
    """A member whose size is not known yet."""
    return archive.open(name, "w", force_zip64=True)


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


@dataclass(frozen=True)
class Doors:
    """What was closed, and what stands open."""

    browsers: int = 0
    """That were signed in, and must sign in again."""
    tokens: int = 0
    """That held when the backup was made and hold by their dates."""
    revoked: bool = False
    """Whether those were revoked."""


def close_doors(connection: Connection, now: datetime, *, revoke: bool) -> Doors:
    """Ends browsers and links, and revokes tokens where that is wanted, within the transaction that restores."""
    known = set(inspect(connection).get_table_names())
    if not {"tokens", "sign_ins", "sign_in_links"} <= known:
        return Doors()
    browsers = connection.scalar(select(func.count()).select_from(SignInRow).where(SignInRow.expires_at > now)) or 0
    for row in (SignInRow, SignInLinkRow, *((AttemptRow,) if "attempts" in known else ())):
        connection.execute(delete(row))
    held = TokenRow.revoked_at.is_(None), TokenRow.expires_at > now
    tokens = connection.scalar(select(func.count()).select_from(TokenRow).where(*held)) or 0
    if revoke:
        connection.execute(update(TokenRow).where(*held).values(revoked_at=now))
    return Doors(browsers, tokens, revoke)
