"""Tables in a workbook: frozen, filtered heading, real dates and numbers, verdicts in colour, text that stays text."""

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from enum import Enum
from math import isfinite
from typing import IO

import xlsxwriter
from xlsxwriter.format import Format
from xlsxwriter.worksheet import Worksheet

from service.languages.catalogue import catalogue_of
from service.languages.language import Language
from service.papers.typeset import PALETTE
from service.sessions.words.conditions import CONDITIONS, REFERENCE

OPTIONS = {"constant_memory": True, "strings_to_formulas": False, "strings_to_urls": False}
"""Rows go to disk as they come, and no text becomes a formula or a link by its appearance."""
FORMULA = re.compile(r"^[=+\-@\t\r]")
"""Beginning of a text that a spreadsheet would evaluate as a formula once it is edited."""
LONGEST_TEXT = 32_767
"""Characters that a cell holds."""

Cell = str | float | int | bool | datetime | None


class CellKind(Enum):
    """Format of a column: that of its numbers, and whether verdicts stand in it."""

    TEXT = "@"
    VERDICT = "General;General"
    NUMBER = "General"
    CHANGE = "0.00"
    SHARE = "0 %"
    CHANCE = "0.00 %"
    DATE = "yyyy-mm-dd"
    TIME = "yyyy-mm-dd hh:mm"


@dataclass(frozen=True)
class Column:
    """One column of a table."""

    name: str
    kind: CellKind = CellKind.TEXT
    width: float = 14.0
    is_named: bool = False
    """Whether its contents are names given by people: they are written unchanged, in every language."""


def naive(at: datetime) -> datetime:
    """A spreadsheet's dates have no zone: UTC, to the second."""
    return at.astimezone(UTC).replace(tzinfo=None, microsecond=0)


def write_text(sheet: Worksheet, place: tuple[int, int], text: str, look: Format) -> None:
    """A text as it is; the library takes one that stands between ``<r>`` and ``</r>`` for its own markup."""
    if text.startswith("<r>"):
        sheet.write_rich_string(*place, text[:1], look, text[1:LONGEST_TEXT], look)
    else:
        sheet.write_string(*place, text[:LONGEST_TEXT], look)


class Workbook:
    """A workbook under construction; rows go to disk as they come, so a large one takes little memory."""

    def __init__(self, target: IO[bytes], made: datetime, title: str, language: Language = Language.ENGLISH) -> None:
        self._say: Callable[[str], str] = str if language is Language.ENGLISH else catalogue_of(language).say
        self._book = xlsxwriter.Workbook(target, OPTIONS)
        self._book.set_properties({"title": self._say(title), "author": "imu-health", "created": naive(made)})
        self._head = self._book.add_format({"bold": True, "bottom": 1, "text_wrap": True, "valign": "top"})
        self._formats: dict[CellKind, Format] = {
            kind: self._book.add_format({"num_format": kind.value}) for kind in CellKind
        }
        self._quoted = self._book.add_format({"quote_prefix": True})
        self._tones = {self._say(c.word): self._tone(c.key) for c in (*CONDITIONS, REFERENCE)}

    def _tone(self, key: str) -> Format:
        return self._book.add_format({"font_color": "#ffffff", "bg_color": PALETTE[key]})

    def table(self, name: str, columns: Sequence[Column], rows: Iterable[Sequence[Cell]]) -> None:
        """One sheet of one table."""
        sheet = self._book.add_worksheet(self._say(name))
        sheet.freeze_panes(1, 1)
        for place, column in enumerate(columns):
            sheet.set_column(place, place, column.width)
            sheet.write_string(0, place, self._say(column.name), self._head)
        last = 0
        for last, row in enumerate(rows, 1):
            for place, (column, cell) in enumerate(zip(columns, row, strict=True)):
                self._write(sheet, (last, place), column, cell)
        sheet.autofilter(0, 0, max(last, 1), len(columns) - 1)
        self._colour(sheet, columns, last)

    def _write(self, sheet: Worksheet, place: tuple[int, int], column: Column, cell: Cell) -> None:
        say = str if column.is_named else self._say
        look = self._formats[column.kind]
        match cell:
            case None:
                pass
            case str():
                text_look = self._quoted if FORMULA.match(cell) else self._formats[CellKind.TEXT]
                write_text(sheet, place, say(cell), text_look)
            case bool():
                sheet.write_string(*place, say("yes" if cell else "no"))
            case datetime():
                sheet.write_datetime(*place, naive(cell), look)
            case _ if isfinite(cell):
                sheet.write_number(*place, cell, look)

    def _colour(self, sheet: Worksheet, columns: Sequence[Column], last: int) -> None:
        """Colours verdicts by rules of the sheet: they follow when somebody sorts or edits. No word of a verdict begins
        like another, and an added reservation changes no colour.
        """
        for place, column in enumerate(columns):
            if column.kind is CellKind.VERDICT and last:
                for word, tone in self._tones.items():
                    rule = {"type": "text", "criteria": "begins with", "value": word, "format": tone}
                    sheet.conditional_format(1, place, last, place, rule)

    def close(self) -> None:
        """Writes the file."""
        self._book.close()
