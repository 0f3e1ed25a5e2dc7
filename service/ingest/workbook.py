"""An XLSX container, checked before its contents are parsed: a few bytes of it may stand for gigabytes.

Members are unpacked here within a limit and packed again plainly, so that no declared size is trusted; the extent of
every sheet and the amount of shared text are bounded.
"""

import re
import zlib
from collections.abc import Iterator
from io import BytesIO
from zipfile import BadZipFile, ZipFile

from service.ingest.limits import MOST_TEXT, check_cells, refusal

MOST_MEMBERS = 1000
"""Parts of a workbook: an ordinary one has some twenty."""
PARSED = (".xml", ".rels")
PLACE = re.compile(rb"""[\s]r\s*=\s*["']\s*([A-Za-z]*)(\d+)""")
SHARED = re.compile(rb"""[\s]t\s*=\s*["']s["']""")
DAMAGED = (BadZipFile, OSError, ValueError, RuntimeError, LookupError, EOFError, zlib.error)
"""What zipfile raises on damaged archives; RuntimeError where a member is encrypted or of an unknown compression."""


def checked_workbook(content: bytes, filename: str) -> bytes:
    """The workbook with its XML members only, stored uncompressed, known to be of bearable size."""
    try:
        members = dict(_unpacked(content))
    except DAMAGED as error:
        raise refusal(filename, "is damaged or not a readable XLSX file; save it again") from error
    except _TooLargeError as error:
        raise refusal(filename, f"unpacks to more than {MOST_TEXT // 1024**2} MiB; average or split it") from error
    references = 0
    for name, data in members.items():
        if name.startswith("xl/worksheets/") and name.endswith(".xml"):
            check_cells(filename, *_extent(data))
            references += len(SHARED.findall(data))
    longest = max(map(len, members.get("xl/sharedStrings.xml", b"").split(b"</si>")))
    if longest * references > MOST_TEXT:
        raise refusal(filename, "holds far too much text; labels should be short")
    return _packed(members)


class _TooLargeError(Exception):
    """The members unpack to more than the limit."""


def _unpacked(content: bytes) -> Iterator[tuple[str, bytes]]:
    left = MOST_TEXT
    with ZipFile(BytesIO(content)) as archive:
        members = archive.infolist()
        if len(members) > MOST_MEMBERS:
            raise _TooLargeError
        for member in members:
            if member.filename.endswith(PARSED):
                with archive.open(member) as stream:
                    data = stream.read(left + 1)
                left -= len(data)
                if left < 0:
                    raise _TooLargeError
                yield member.filename, data


def _extent(sheet: bytes) -> tuple[int, int]:
    """Rows and columns up to the furthest cell that the sheet names."""
    rows, widest = 1, b"A"
    for column, row in PLACE.findall(sheet):
        rows = max(rows, int(row[:10]))
        widest = max(widest, column.upper(), key=lambda letters: (len(letters), letters))
    columns = 0
    for letter in widest[:6]:
        columns = columns * 26 + letter - 64
    return rows, columns


def _packed(members: dict[str, bytes]) -> bytes:
    buffer = BytesIO()
    with ZipFile(buffer, "w") as archive:
        for name, data in members.items():
            archive.writestr(name, data)
    return buffer.getvalue()
