"""What a backup says of itself, and the names within it.

A backup is a zip file. Its table of contents stands at its end, so one that was cut off cannot be opened; the manifest
is written last.

    tables/NAME.jsonl   a line a row: the values in the order of the manifest's columns
    files/SHA256        an uploaded file under its hash
    manifest.json       this
"""

import zipfile
import zlib
from datetime import datetime
from pathlib import Path
from typing import IO, Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, StringConstraints, ValidationError

from service.errors import ServiceError

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
