"""XLSX: sheet `readings` with a header row, sheet `session` with keys and values such as `sensors[1].name` | A1."""

import zlib
from collections import Counter
from collections.abc import Mapping, Sequence
from io import BytesIO
from pathlib import PurePosixPath
from string import ascii_uppercase
from typing import Literal
from xml.parsers import expat
from zipfile import BadZipFile, ZipFile, ZipInfo

import fastexcel
import numpy as np
import polars as pl

from estimator.errors import FormatError
from estimator.message import say
from estimator.reading.columns import Column
from estimator.reading.csv_text import named_columns
from estimator.reading.problems import Problems, Where
from service.ingest.foreign import require_workbook
from service.ingest.in_russian import CHOSEN, IN_ENGLISH, heading_in_english, key_in_english, value_in_english
from service.ingest.metadata import TEXTS, last_step, nested
from service.kit.limits import check_table, in_force, refusal

MOST_MEMBERS = 1000
"""Parts of a workbook: an ordinary one has some twenty."""
MOST_TEXT = 64 * 1024 * 1024
"""Characters of all cells of shared text together."""
CHUNK = 64 * 1024
"""Bytes that are unpacked at a time."""
PICTURES = (".png", ".jpg", ".jpeg", ".gif", ".emf", ".bin", ".vml")
"""Parts that are not XML; only their size matters."""
DAMAGED = (
    BadZipFile, OSError, ValueError, RuntimeError, LookupError, EOFError, UnicodeError, zlib.error, expat.ExpatError,
)  # fmt: skip
"""Raised for damaged archives; RuntimeError where a member is encrypted or of an unknown compression."""


class TooMuchError(Exception):
    """A part exceeds the limit; its message names what."""


def check_workbook(content: bytes, filename: str) -> None:
    """Raises FormatError for a workbook that is damaged, or exceeds the limits."""
    lengths: list[int] = []
    shared: Counter[int] = Counter()
    extents: list[tuple[int, int]] = []
    try:
        _check_members(content, filename, lengths, shared, extents)
    except TooMuchError as error:
        raise refusal(filename, "{error}; average or split it", error=error) from error
    except FormatError:
        raise  # it is another kind of archive
    except DAMAGED as error:
        raise refusal(filename, "is damaged or not a readable XLSX file; save it again") from error
    for rows, columns in extents:
        check_table(filename, rows, columns)
    if sum(count * lengths[place] for place, count in shared.items() if place < len(lengths)) > MOST_TEXT:
        raise refusal(filename, "contains far too much text; labels should be short")


def _check_members(
    content: bytes, filename: str, lengths: list[int], shared: Counter[int], extents: list[tuple[int, int]]
) -> None:
    left = in_force().unpacked
    with ZipFile(BytesIO(content)) as archive:
        members = archive.infolist()
        if len(members) > MOST_MEMBERS:
            raise TooMuchError(say("has {members} parts; a workbook has about twenty", members=len(members)))
        require_workbook((member.filename for member in members), filename)
        for member in members:
            part = _XmlPart(lengths, shared)
            left -= _streamed(archive, member, part, left)
            extents.append((part.rows, part.columns))


def _streamed(archive: ZipFile, member: ZipInfo, part: "_XmlPart", limit: int) -> int:
    is_xml = PurePosixPath(member.filename.lower()).suffix not in PICTURES
    total = 0
    with archive.open(member) as stream:
        while chunk := stream.read(CHUNK):
            total += len(chunk)
            if total > limit:
                raise TooMuchError(say("unpacks to more than {unpacked} MiB", unpacked=in_force().unpacked // 1024**2))
            if is_xml:
                part.parser.Parse(chunk, False)
    if is_xml and total:
        part.parser.Parse(b"", True)
    return total


class _XmlPart:
    """One XML part: the extent of its cells, the lengths of shared texts and how often each is used."""

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
            self._column = _column_number(stated["r"]) if "r" in stated else self._column + 1
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
        """Extends to the current cell; ends the reading where that exceeds the limits."""
        self.rows, self.columns = max(self.rows, self._row), max(self.columns, self._column)
        limits = self._most
        if self.rows > limits.rows or self.columns > limits.columns or self.rows * self.columns > limits.cells:
            raise TooMuchError(
                say(
                    "has {rows} rows × {columns} columns in a sheet; at most {cell_limit} cells, {row_limit} rows and "
                    "{column_limit} columns can be read",
                    rows=self.rows,
                    columns=self.columns,
                    cell_limit=limits.cells,
                    row_limit=limits.rows,
                    column_limit=limits.columns,
                )
            )


def _column_number(place: str) -> int:
    """AB12 → 28."""
    number = 0
    for letter in place.strip().upper().rstrip("0123456789"):
        number = number * 26 + ord(letter) - 64
    return number


def _row(place: str) -> int:
    """AB12 → 12."""
    return int(place.strip().lstrip("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ$"))


BOOLEANS = ("true", "false")
"""Texts by which the library gives a boolean cell, which as a number would be 1 or 0."""
DType = Literal["string", "float"]
Cell = float | str | None
Names = tuple[str, str]
"""Names of the two sheets of a session, in a workbook."""
SHEETS = ("session", "readings")
"""English names of the two sheets."""


def read_xlsx(content: bytes, filename: str) -> dict[str, object]:
    """The document that a workbook holds."""
    return read_with_places(content, filename)[0]


def read_with_places(content: bytes, filename: str) -> tuple[dict[str, object], Where]:
    """The session document of a workbook, with a function from field and row to the cell."""
    check_workbook(content, filename)
    names, session, readings = _sheets(content, filename)
    problems = Problems(filename, in_force().extent)
    document = nested([row for row in session if row[0].strip()], problems)
    table = named_columns(*readings, problems)
    problems.raise_if_any()
    return document | {"table": table}, _places(names, [key for key, _ in session], readings[0])


def _places(names: Names, keys: list[str], header: list[str]) -> Where:
    """``cell C7 of the sheet readings``; a key's line is that of the sheet."""
    lines = {key.strip(): line for line, key in enumerate(keys, start=1)}
    letters = {name.strip(): letters_of(number) for number, name in enumerate(header, start=1)}
    session, readings = names

    def where(field: str, row: int | None) -> str:
        if row is not None and field in letters:
            return say(
                "cell {letters}{row} of the sheet {readings}", letters=letters[field], row=row + 1, readings=readings
            )
        if row is None and field in letters:
            return say("column {letters} of the sheet {readings}", letters=letters[field], readings=readings)
        return (
            say("cell B{lines} of the sheet {session}", lines=lines[field], session=session) if field in lines else ""
        )

    return where


def letters_of(number: int) -> str:
    """28 → AB, as a spreadsheet names its columns."""
    letters = ""
    while number > 0:
        number, rest = divmod(number - 1, len(ascii_uppercase))
        letters = ascii_uppercase[rest] + letters
    return letters


def sheet_names(content: bytes, filename: str) -> tuple[str, ...]:
    """The names of a workbook's sheets."""
    check_workbook(content, filename)
    try:
        return tuple(fastexcel.read_excel(content).sheet_names)
    except fastexcel.FastExcelError as error:
        raise refusal(filename, "is damaged or not a readable XLSX file; save it again") from error


def session_sheets(names: Sequence[str]) -> Names | None:
    """The two sheets of a session among those of a workbook, in English or Russian; None for any other workbook."""
    by_english = {IN_ENGLISH.get(name.strip(), name): name for name in reversed(names)}
    return (by_english["session"], by_english["readings"]) if by_english.keys() >= set(SHEETS) else None


def _sheets(content: bytes, filename: str) -> tuple[Names, list[tuple[str, Cell]], tuple[list[str], list[Column]]]:
    """The sheets' names; keys and values of the first; header and columns of the second."""
    try:
        book = fastexcel.read_excel(content)
        names = session_sheets(book.sheet_names)
        if names is not None:
            return names, _key_values(book, names[0]), _table(book, names[1])
        missing = [name for name in SHEETS if name not in book.sheet_names]
    except fastexcel.FastExcelError as error:
        raise refusal(filename, "is damaged or not a readable XLSX file; save it again") from error
    text = say(
        "has no sheet {missing}; a session needs both, a table of your own a mapping",
        missing=" and no sheet ".join(missing),
    )
    raise refusal(filename, text)


def _key_values(book: fastexcel.ExcelReader, sheet: str) -> list[tuple[str, Cell]]:
    """Keys in English."""
    texts = _load(book, sheet, "string").get_columns()
    if len(texts) < 2:
        return []
    values = _cells(_load(book, sheet, "float").get_columns()[1], texts[1])
    keys = [key_in_english(key or "") for key in texts[0]]
    rows = zip(keys, values, texts[1].to_list(), strict=True)
    return [(key, _value(last_step(key), value, text)) for key, value, text in rows]


def _value(name: str, value: Cell, text: str | None) -> Cell:
    return value_in_english(name, text if name in TEXTS else value)


def _table(book: fastexcel.ExcelReader, sheet: str) -> tuple[list[str], list[Column]]:
    """Headings in English; without the empty rows that a spreadsheet keeps at its end."""
    texts, numbers = _load(book, sheet, "string"), _load(book, sheet, "float")
    if texts.is_empty():
        return [], []
    header = [heading_in_english(text or "") for text in texts.row(0)]
    ends = [np.flatnonzero(series.is_not_null().to_numpy()) for series in texts.slice(1)]
    count = max((int(rows[-1]) + 1 for rows in ends if len(rows)), default=0)
    pairs = zip(header, numbers.slice(1, count), texts.slice(1, count), strict=True)
    return header, [_column(name, *cells) for name, *cells in pairs]


def _column(name: str, numbers: pl.Series, texts: pl.Series) -> Column:
    cells = _cells(numbers, texts)
    return [value_in_english(name, cell) for cell in cells] if name in CHOSEN else cells


def _load(book: fastexcel.ExcelReader, sheet: str, dtype: DType) -> pl.DataFrame:
    return book.load_sheet(sheet, header_row=None, dtypes=dtype).to_polars()


def _cells(numbers: pl.Series, texts: pl.Series) -> Column:
    """Numbers where a cell is one, else its text. As text, the library rounds numbers to nine decimals."""
    is_number = numbers.is_not_null() & ~texts.is_in(BOOLEANS).fill_null(False)
    if is_number.all():
        return numbers.to_numpy()
    values = numbers.to_list()
    return [values[j] if is_sure else text for j, (is_sure, text) in enumerate(zip(is_number, texts, strict=True))]
