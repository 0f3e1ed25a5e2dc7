"""Rows of a sheet as the file of a workbook holds them (SpreadsheetML), and how they come into it.

A library that keeps every cell as an object takes seven microseconds for each, and a large fleet has a million. It
makes the workbook with its looks, headings and rules; rows are written here as text, and put into its sheets.
"""

import re
import shutil
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import lru_cache
from math import isfinite
from typing import IO
from xml.sax.saxutils import escape
from zipfile import ZIP_DEFLATED, ZipFile

from xlsxwriter.utility import xl_col_to_name

FORMULA = re.compile(r"^[=+\-@\t\r]")
"""How a text begins that a spreadsheet would work out once it is edited."""
LONGEST_TEXT = 32_767
"""Characters that a cell holds."""
EPOCH, DAY = datetime(1899, 12, 30), 86_400.0
"""Day 0 of a spreadsheet, for every date since March 1900, and its seconds."""
LOOKS_WRITTEN = re.compile("_(?=x[0-9A-Fa-f]{4}_)")
UNSEEN = re.compile("[\x00-\x08\x0b-\x1f\ufffe\uffff]")
"""What XML cannot hold is written ``_x0007_``, and what looks so by chance is marked (ECMA-376 part 1, ST_Xstring)."""
KEPT = 10_000
"""Texts of a column that are kept as they were written: names and verdicts stand in thousands of rows."""
END = b"</sheetData>"
"""Of the rows of a sheet."""
EXTENT = re.compile(rb'<dimension ref="[^"]*"/>')

Cell = str | float | int | bool | datetime | None


@dataclass(frozen=True)
class Looks:
    """Under which numbers the workbook's file knows the looks of a column."""

    number: int
    """Of numbers and dates."""
    text: int
    quoted: int
    """Of a text that begins as a formula does."""


@dataclass(frozen=True)
class Rows:
    """All rows of a sheet below its heading."""

    content: IO[bytes]
    extent: str
    """With the heading: ``A1:C20``."""


def naive(at: datetime) -> datetime:
    """A spreadsheet's dates have no zone: UTC, to the second."""
    return at.astimezone(UTC).replace(tzinfo=None, microsecond=0)


def writer(place: int, looks: Looks, say: Callable[[str], str]) -> Callable[[int, Cell], str]:
    """What writes the cells of a column: number of the row and value → XML, nothing of an empty cell."""
    column = f'<c r="{xl_col_to_name(place)}'

    @lru_cache(KEPT)
    def text(value: str) -> str:
        look = looks.quoted if FORMULA.match(value) else looks.text
        return f's="{look}" {_inline(say(value)[:LONGEST_TEXT])}'

    def write(row: int, value: Cell) -> str:
        match value:
            case None:
                return ""
            case str():
                return f'{column}{row}" {text(value)}'
            case bool():
                return f'{column}{row}" {_inline(say("yes" if value else "no"))}'
            case datetime():
                days = (naive(value) - EPOCH).total_seconds() / DAY
                return f'{column}{row}" s="{looks.number}"><v>{days:.16G}</v></c>'
            case _:
                return f'{column}{row}" s="{looks.number}"><v>{value:.16G}</v></c>' if isfinite(value) else ""

    return write


def _inline(text: str) -> str:
    """A text that stands in its cell, and the cell's end."""
    marked = UNSEEN.sub(lambda found: f"_x{ord(found[0]):04X}_", LOOKS_WRITTEN.sub("_x005F_", text))
    return f't="inlineStr"><is><t xml:space="preserve">{escape(marked)}</t></is></c>'


def put_rows(made: IO[bytes], rows: Mapping[str, Rows], target: IO[bytes]) -> None:
    """The workbook that was made, with rows below the headings of its sheets, by the names of their parts."""
    with ZipFile(made) as source, ZipFile(target, "w", ZIP_DEFLATED) as whole:
        for part in source.infolist():
            content = source.read(part)
            with whole.open(part, "w") as out:
                if part.filename not in rows:
                    out.write(content)
                    continue
                own = rows[part.filename]
                head, foot = EXTENT.sub(f'<dimension ref="{own.extent}"/>'.encode(), content, 1).split(END)
                out.write(head)
                own.content.seek(0)
                shutil.copyfileobj(own.content, out)
                out.write(END + foot)
