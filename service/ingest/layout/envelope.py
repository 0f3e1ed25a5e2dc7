"""The uploaded bytes, unchanged, and the mapping that reads them, in one file: a ZIP archive of two parts.

Neither is of use without the other, so they are stored, backed up, checked and passed on as one. The archive is
uncompressed and undated: the same bytes under the same mapping are the same file; under another mapping they are
another file. Whether that is another session is decided by its content.
"""

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from shutil import copyfileobj
from struct import Struct
from typing import IO, Any
from zipfile import ZIP_STORED, BadZipFile, ZipFile, ZipInfo

from estimator.errors import SessionError
from estimator.json_object import Json
from estimator.reading.json_text import parse_json
from estimator.reading.problems import Problems
from service.ingest.formats import HDF5, MAT, MCAP, PARQUET, SQLITE, ULOG, XLSX, start_of
from service.kit.limits import in_force, refusal

MAPPING = "imu-mapping.json"
"""Name of the first part."""
NAME_AT = 30
"""Byte of a ZIP archive at which the name of its first part begins (APPNOTE 4.3.7)."""
LENGTHS_AT, LENGTHS = 26, Struct("<HH")
"""Byte of a part's header with the lengths of its name and of the extra field behind it."""
ENDINGS = (
    (XLSX, "xlsx"), (PARQUET, "parquet"), (HDF5, "h5"), (MAT, "mat"), (ULOG, "ulg"), (MCAP, "mcap"), (SQLITE, "db3"),
)  # fmt: skip
"""Extension of the second part's name, by its first bytes; anything else is text."""
LONGEST_MAGIC = max(len(magic) for magic, _ in ENDINGS)
COPIED = 1024 * 1024
"""Bytes that are copied at a time."""
LONGEST_MAPPING = 1024 * 1024
"""Bytes; ten thousand columns take less."""
PARTS = 2
UNREADABLE = (
    BadZipFile,  # a broken header
    ValueError,  # a place before the beginning, or a name in no code
    EOFError,  # its end comes too soon
    RuntimeError,  # a part that claims to be encrypted, or packed in a way that zipfile does not know
)
"""Raised by zipfile for archives that are not ours."""


@dataclass(frozen=True)
class StoredTable:
    """The bytes of a table in a file, which may hold others around them."""

    path: Path
    begins: int
    size: int

    def read(self, at: int, count: int) -> bytes:
        """Some of its bytes; fewer at its end."""
        with self.path.open("rb") as file:
            file.seek(self.begins + at)
            return file.read(max(min(count, self.size - at), 0))


def wrapped(mapping: Mapping[str, Any], content: bytes) -> bytes:
    """The file that is stored."""
    buffer = BytesIO()
    wrap(mapping, content, buffer)
    return buffer.getvalue()


def wrap(mapping: Mapping[str, Any], content: bytes | Path, file: IO[bytes]) -> None:
    """Writes the file that is stored, without holding a long table in memory."""
    start, size = (
        start_of(content, LONGEST_MAGIC),
        len(content) if isinstance(content, bytes) else content.stat().st_size,
    )
    ending = next((ending for magic, ending in ENDINGS if start.startswith(magic)), "csv")
    text = json.dumps(mapping, ensure_ascii=False, sort_keys=True, separators=(",", ":")).encode()
    table = ZipInfo(f"table.{ending}")
    table.file_size = size
    with ZipFile(file, "w", ZIP_STORED) as archive:
        archive.writestr(ZipInfo(MAPPING), text)
        with (
            archive.open(table, "w") as part,
            BytesIO(content) if isinstance(content, bytes) else content.open("rb") as source,
        ):
            copyfileobj(source, part, COPIED)


def is_wrapped(content: bytes | Path) -> bool:
    """Whether a file is such an archive."""
    name = MAPPING.encode()
    start = start_of(content, NAME_AT + len(name))
    return start.startswith(XLSX) and start[NAME_AT:] == name


def unwrapped(content: bytes, filename: str) -> tuple[Json, bytes]:
    """The mapping and the uploaded bytes; FormatError for a damaged archive."""
    with _parts(BytesIO(content), filename) as (archive, (text, table)):
        return mapping_of(archive.read(text), filename), archive.read(table)


def table_in(path: Path, filename: str) -> tuple[Json, StoredTable]:
    """The mapping, and the place of the uploaded bytes; FormatError for a damaged archive."""
    with path.open("rb") as file, _parts(file, filename) as (archive, (text, table)):
        archive.open(table).close()  # checks its header
        file.seek(table.header_offset + LENGTHS_AT)
        begins = table.header_offset + NAME_AT + sum(LENGTHS.unpack(file.read(LENGTHS.size)))
        return mapping_of(archive.read(text), filename), StoredTable(path, begins, table.file_size)


@contextmanager
def _parts(file: IO[bytes], filename: str) -> Iterator[tuple[ZipFile, list[ZipInfo]]]:
    try:
        with ZipFile(file) as archive:
            parts = archive.infolist()
            if len(parts) != PARTS or any(part.compress_type != ZIP_STORED for part in parts):
                raise refusal(filename, "must contain two uncompressed parts: {mapping} and the table", mapping=MAPPING)
            yield archive, parts
    except UNREADABLE as error:
        if isinstance(error, SessionError):
            raise
        raise refusal(filename, "is damaged; upload the table and its mapping again") from error


def mapping_of(text: bytes, filename: str) -> Json:
    """The mapping in a JSON text, not yet checked."""
    if len(text) > LONGEST_MAPPING:
        raise refusal(filename, "is longer than {longest_mapping} bytes", "mapping", longest_mapping=LONGEST_MAPPING)
    problems = Problems(filename, in_force().extent)
    document = parse_json(text.decode("utf-8", errors="replace"), problems)
    problems.raise_if_any()
    return document
