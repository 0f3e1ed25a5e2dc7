"""The uploaded bytes, unchanged, and the mapping that reads them, in one file: a ZIP archive of two parts.

Neither is of use without the other, so they are stored, backed up, checked and passed on as one. The archive is
uncompressed and undated: the same bytes under the same mapping are the same file; under another mapping they are
another file. Whether that is another session is decided by its content.
"""

import json
from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import Any
from zipfile import ZIP_STORED, BadZipFile, ZipFile, ZipInfo

from estimator.json_object import Json
from estimator.reading.json_text import parse_json
from estimator.reading.problems import Problems
from service.ingest.formats import HDF5, MAT, MCAP, PARQUET, SQLITE, ULOG, XLSX, start_of
from service.kit.limits import in_force, refusal

MAPPING = "imu-mapping.json"
"""Name of the first part."""
NAME_AT = 30
"""Byte of a ZIP archive at which the name of its first part begins (APPNOTE 4.3.7)."""
ENDINGS = (
    (XLSX, "xlsx"), (PARQUET, "parquet"), (HDF5, "h5"), (MAT, "mat"), (ULOG, "ulg"), (MCAP, "mcap"), (SQLITE, "db3"),
)  # fmt: skip
"""Extension of the second part's name, by its first bytes; anything else is text."""
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


def wrapped(mapping: Mapping[str, Any], content: bytes) -> bytes:
    """The file that is stored."""
    ending = next((ending for magic, ending in ENDINGS if content.startswith(magic)), "csv")
    text = json.dumps(mapping, ensure_ascii=False, sort_keys=True, separators=(",", ":")).encode()
    buffer = BytesIO()
    with ZipFile(buffer, "w", ZIP_STORED) as archive:
        for name, part in ((MAPPING, text), (f"table.{ending}", content)):
            archive.writestr(ZipInfo(name), part)
    return buffer.getvalue()


def is_wrapped(content: bytes | Path) -> bool:
    """Whether a file is such an archive."""
    name = MAPPING.encode()
    start = start_of(content, NAME_AT + len(name))
    return start.startswith(XLSX) and start[NAME_AT:] == name


def unwrapped(content: bytes, filename: str) -> tuple[Json, bytes]:
    """The mapping and the uploaded bytes; FormatError for a damaged archive."""
    try:
        with ZipFile(BytesIO(content)) as archive:
            parts = archive.infolist()
            if len(parts) != PARTS or any(part.compress_type != ZIP_STORED for part in parts):
                raise refusal(filename, "must contain two uncompressed parts: {mapping} and the table", mapping=MAPPING)
            text, table = (archive.read(part) for part in parts)
    except UNREADABLE as error:
        raise refusal(filename, "is damaged; upload the table and its mapping again") from error
    return mapping_of(text, filename), table


def mapping_of(text: bytes, filename: str) -> Json:
    """The mapping in a JSON text, not yet checked."""
    if len(text) > LONGEST_MAPPING:
        raise refusal(filename, "is longer than {longest_mapping} bytes", "mapping", longest_mapping=LONGEST_MAPPING)
    problems = Problems(filename, in_force().extent)
    document = parse_json(text.decode("utf-8", errors="replace"), problems)
    problems.raise_if_any()
    return document
