"""An XLSX container, looked through before its contents are parsed: a few bytes of it may stand for gigabytes.

Every XML part is read as a stream, wherever it lies and whatever it is called, so that the extent of each sheet is
known as the parser will take it: with and without stated places, in any notation. Declared sizes are not trusted.
"""

import zlib
from collections import Counter
from collections.abc import Mapping
from io import BytesIO
from pathlib import PurePosixPath
from xml.parsers import expat
from zipfile import BadZipFile, ZipFile, ZipInfo

from estimator.message import say
from service.kit.limits import check_table, in_force, refusal

MOST_MEMBERS = 1000
"""Parts of a workbook: an ordinary one has some twenty."""
MOST_TEXT = 64 * 1024 * 1024
"""Characters that all cells of shared text hold together."""
CHUNK = 64 * 1024
"""Bytes that are unpacked at a time."""
PICTURES = (".png", ".jpg", ".jpeg", ".gif", ".emf", ".bin", ".vml")
"""Parts that are no XML; nothing but their size matters."""
DAMAGED = (
    BadZipFile, OSError, ValueError, RuntimeError, LookupError, EOFError, UnicodeError, zlib.error, expat.ExpatError,
)  # fmt: skip
"""What damaged archives raise; RuntimeError where a member is encrypted or of an unknown compression."""


class TooMuchError(Exception):
    """A part that holds more than the limit; says of what."""


def check_workbook(content: bytes, filename: str) -> None:
    """Raises FormatError for a workbook that is damaged, or that holds more than the limits."""
    lengths: list[int] = []
    shared: Counter[int] = Counter()
    extents: list[tuple[int, int]] = []
    try:
        _look_through(content, lengths, shared, extents)
    except TooMuchError as error:
        raise refusal(filename, say("{error}; average or split it", error=error)) from error
    except DAMAGED as error:
        raise refusal(filename, "is damaged or not a readable XLSX file; save it again") from error
    for rows, columns in extents:
        check_table(filename, rows, columns)
    if sum(count * lengths[place] for place, count in shared.items() if place < len(lengths)) > MOST_TEXT:
        raise refusal(filename, "holds far too much text; labels should be short")


def _look_through(content: bytes, lengths: list[int], shared: Counter[int], extents: list[tuple[int, int]]) -> None:
    left = in_force().unpacked
    with ZipFile(BytesIO(content)) as archive:
        members = archive.infolist()
        if len(members) > MOST_MEMBERS:
            raise TooMuchError(say("has {members} parts, where a workbook has some twenty", members=len(members)))
        for member in members:
            part = _Part(lengths, shared)
            left -= _streamed(archive, member, part, left)
            extents.append((part.rows, part.columns))


def _streamed(archive: ZipFile, member: ZipInfo, part: "_Part", left: int) -> int:
    """Bytes that the member unpacks to."""
    is_xml = PurePosixPath(member.filename.lower()).suffix not in PICTURES
    total = 0
    with archive.open(member) as stream:
        while chunk := stream.read(CHUNK):
            total += len(chunk)
            if total > left:
                raise TooMuchError(say("unpacks to more than {unpacked} MiB", unpacked=in_force().unpacked // 1024**2))
            if is_xml:
                part.parser.Parse(chunk, False)
    if is_xml and total:
        part.parser.Parse(b"", True)
    return total


class _Part:
    """One XML part: how far its cells reach, and how long shared texts are and how often each is used."""

    def __init__(self, lengths: list[int], shared: Counter[int]) -> None:
        self.rows = self.columns = 0
        self._lengths, self._shared = lengths, shared
        self._row = self._column = 0
        self._most = in_force()
        self._is_shared = self._in_value = False
        self._value = ""
        self.parser = expat.ParserCreate()
        self.parser.buffer_text = True
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = self._end
        self.parser.StartDoctypeDeclHandler = self._doctype

    def _start(self, name: str, stated: Mapping[str, str]) -> None:
        kind = name.rpartition(":")[2]
        if kind == "c":
            self._column = _column(stated["r"]) if "r" in stated else self._column + 1
            self._row = _row(stated["r"]) if "r" in stated else self._row
            self._reach()
            self._is_shared = stated.get("t") == "s"
        elif kind == "row":
            self._row = int(stated["r"]) if "r" in stated else self._row + 1
            self._column = 0
            self._reach()
        elif kind == "si":
            self._lengths.append(0)
            self.parser.CharacterDataHandler = self._shared_text
        elif kind == "v" and self._is_shared:
            self._value = ""
            self.parser.CharacterDataHandler = self._place

    def _end(self, name: str) -> None:
        kind = name.rpartition(":")[2]
        if kind == "si":
            self.parser.CharacterDataHandler = None
        elif kind == "v" and self._is_shared:
            self.parser.CharacterDataHandler = None
            self._shared[int(self._value or 0)] += 1

    def _shared_text(self, text: str) -> None:
        self._lengths[-1] += len(text)

    def _place(self, text: str) -> None:
        self._value += text

    def _doctype(self, *_: object) -> None:
        raise ValueError("a workbook declares no document type")

    def _reach(self) -> None:
        """Takes in the cell at hand; ends the reading where that is too far already."""
        self.rows, self.columns = max(self.rows, self._row), max(self.columns, self._column)
        most = self._most
        if self.rows > most.rows or self.columns > most.columns or self.rows * self.columns > most.cells:
            raise TooMuchError(
                say(
                    "has {rows} rows × {columns} columns in a sheet; at most {cells} cells, {rows2} rows and "
                    "{columns2} columns can be read",
                    rows=self.rows,
                    columns=self.columns,
                    cells=most.cells,
                    rows2=most.rows,
                    columns2=most.columns,
                )
            )


def _column(place: str) -> int:
    """AB12 → 28."""
    number = 0
    for letter in place.strip().upper().rstrip("0123456789"):
        number = number * 26 + ord(letter) - 64
    return number


def _row(place: str) -> int:
    """AB12 → 12."""
    return int(place.strip().lstrip("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ$"))
