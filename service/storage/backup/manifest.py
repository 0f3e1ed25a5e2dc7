"""Manifest of a backup, and the names within it.

A backup is a zip file. Its directory is at its end, so a truncated one cannot be opened; the manifest is written last.

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
"""Raised on reading a damaged backup."""


Hash = Annotated[str, StringConstraints(pattern=HASH)]


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class TableContents(_Part):
    """One table."""

    name: str = Field(pattern="^[a-z_0-9]+$")
    columns: tuple[str, ...]
    rows: int = Field(ge=0)
    sha256: str = Field(pattern=HASH)
    """SHA-256 of the lines."""

    @property
    def member(self) -> str:
        """Name of the table in the backup."""
        return f"tables/{self.name}.jsonl"


class Manifest(_Part):
    """Contents of a backup."""

    format: Literal["imu-backup/1"] = "imu-backup/1"
    version: str
    """Version of the program that wrote it."""
    revision: str
    """Revision of the schema."""
    made_at: datetime
    tables: tuple[TableContents, ...]
    """Tables in order of insertion: referenced tables come first."""
    files: tuple[Hash, ...]
    lost: tuple[str, ...]
    """Hashes of files that sessions name, but that were missing or damaged when the backup was made."""

    @property
    def members(self) -> set[str]:
        """Names of all members of the backup."""
        return {MANIFEST, *(table.member for table in self.tables), *map(file_member, self.files)}


def file_member(digest: str) -> str:
    """The name of an uploaded file in the backup."""
    return f"files/{digest}"


def opened(file: Path) -> zipfile.ZipFile:
    """Opens a backup; ServiceError for any other file, or a truncated one."""
    try:
        return zipfile.ZipFile(file)
    except (FileNotFoundError, PermissionError):
        raise
    except UNREADABLE as fault:
        raise ServiceError(f"{file} is not a backup, or was cut off: {fault}.") from fault


def read_manifest(archive: zipfile.ZipFile) -> Manifest:
    """The manifest; ServiceError where this version does not support it."""
    try:
        manifest = Manifest.model_validate_json(archive.read(MANIFEST))
    except (*UNREADABLE, ValidationError) as fault:
        raise ServiceError(f"{archive.filename} is no backup that this version understands.") from fault
    return manifest


def write_manifest(archive: zipfile.ZipFile, manifest: Manifest) -> None:
    """Writes the manifest, as the last member."""
    archive.writestr(MANIFEST, manifest.model_dump_json(indent=1))


def member_to_write(archive: zipfile.ZipFile, name: str) -> IO[bytes]:
    """A member of unknown size."""
    return archive.open(name, "w", force_zip64=True)


HASHES = "sha256"
"""Column, in any table, with the hash of a stored file; empty where there is none."""
SENT = "sent"
"""Column of a file that waits, with its ``place``."""


def faulty_names(archive: zipfile.ZipFile, table: TableContents) -> Iterator[str]:
    """Rows of a table with an invalid file name; the table itself was verified."""
    columns = [index for index, name in enumerate(table.columns) if name in (HASHES, SENT)]
    if not columns:
        return
    with archive.open(table.member) as lines:
        for number, line in enumerate(lines, start=1):
            values = json.loads(line)
            for index in columns:
                name = _name(table.columns[index], values[index])
                if name and not is_name(name):
                    yield f"table {table.name}, row {number}: {str(name)[:100]!r} is not the name of a stored file"


def _name(column: str, value: Any) -> Any:
    """The hash or place of a row's file; None where the row names no file."""
    if column == HASHES or value is None:
        return value
    document = json.loads(value)
    return None if document is None else document.get("place")


@dataclass(frozen=True)
class RevokedAccess:
    """Access that was revoked, and that remains."""

    browsers: int = 0
    """Browsers that were signed in, and must sign in again."""
    tokens: int = 0
    """Tokens that were valid when the backup was made and have not expired."""
    revoked: bool = False
    """Whether the tokens were revoked."""


def revoke_access(connection: Connection, now: datetime, *, revoke: bool) -> RevokedAccess:
    """Signs out browsers, ends links, and revokes tokens if wanted, within the transaction that restores."""
    table_names = set(inspect(connection).get_table_names())
    if not {"tokens", "sign_ins", "sign_in_links"} <= table_names:
        return RevokedAccess()
    browsers = connection.scalar(select(func.count()).select_from(SignInRow).where(SignInRow.expires_at > now)) or 0
    for row in (SignInRow, SignInLinkRow, *((AttemptRow,) if "attempts" in table_names else ())):
        connection.execute(delete(row))
    valid = TokenRow.revoked_at.is_(None), TokenRow.expires_at > now
    tokens = connection.scalar(select(func.count()).select_from(TokenRow).where(*valid)) or 0
    if revoke:
        connection.execute(update(TokenRow).where(*valid).values(revoked_at=now))
    return RevokedAccess(browsers, tokens, revoke)
