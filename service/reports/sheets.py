"""Tables in a workbook: frozen, filtered heading, real dates and numbers, verdicts in colour, text that stays text."""

import tempfile
from collections.abc import Callable, Iterable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from datetime import datetime
from enum import Enum
from io import BytesIO
from typing import IO

import xlsxwriter
from xlsxwriter.format import Format
from xlsxwriter.utility import xl_range
from xlsxwriter.worksheet import Worksheet

from service.languages.catalogue import catalogue_of
from service.languages.language import Language
from service.reports.pictures import PALETTE
from service.reports.sheet_rows import Cell, Looks, Rows, naive, put_rows, writer
from service.words.conditions import CONDITIONS, REFERENCE

OPTIONS = {"constant_memory": True, "strings_to_formulas": False, "strings_to_urls": False}
"""Rows go to disk as they come, and no text becomes a formula or a link by what it looks like."""


class Kind(Enum):
    """How a column is written: the format of its numbers, and whether verdicts stand in it."""

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
    kind: Kind = Kind.TEXT
    width: float = 14.0
    is_named: bool = False
    """Whether people name what stands in it: that is written as they did, in every language."""


class Workbook:
    """A workbook under construction; rows go to disk as they come, so a large one takes little memory."""

    def __init__(self, target: IO[bytes], made: datetime, title: str, language: Language = Language.ENGLISH) -> None:
        self._say: Callable[[str], str] = str if language is Language.ENGLISH else catalogue_of(language).say
        self._target, self._made = target, BytesIO()
        self._rows: dict[str, Rows] = {}
        self._files = ExitStack()
        self._book = xlsxwriter.Workbook(self._made, OPTIONS)
        self._book.set_properties({"title": self._say(title), "author": "imu-health", "created": naive(made)})
        self._head = self._book.add_format({"bold": True, "bottom": 1, "text_wrap": True, "valign": "top"})
        self._formats: dict[Kind, Format] = {kind: self._book.add_format({"num_format": kind.value}) for kind in Kind}
        self._quoted = self._book.add_format({"quote_prefix": True})
        self._tones = {
            self._say(word): self._tone(c.key) for c in (*CONDITIONS, REFERENCE) for word in (c.formal, c.word)
        }

    def _tone(self, key: str) -> Format:
        return self._book.add_format({"font_color": "#ffffff", "bg_color": PALETTE[key]})

    def table(self, name: str, columns: Sequence[Column], rows: Iterable[Sequence[Cell]]) -> None:
        """One sheet of one table."""
        sheet = self._book.add_worksheet(self._say(name))
        sheet.freeze_panes(1, 1)
        for place, column in enumerate(columns):
            sheet.set_column(place, place, column.width)
            sheet.write_string(0, place, self._say(column.name), self._head)
        content = self._files.enter_context(tempfile.TemporaryFile(prefix="imu-sheet-"))  # noqa: SIM115 - it is
        last = self._written(columns, rows, content)
        part = f"xl/worksheets/sheet{len(self._rows) + 1}.xml"
        self._rows[part] = Rows(content, xl_range(0, 0, last, len(columns) - 1))
        sheet.autofilter(0, 0, max(last, 1), len(columns) - 1)
        self._colour(sheet, columns, last)

    def _written(self, columns: Sequence[Column], rows: Iterable[Sequence[Cell]], content: IO[bytes]) -> int:
        """How many rows there are."""
        writers = [
            writer(place, self._looks(column.kind), str if column.is_named else self._say)
            for place, column in enumerate(columns)
        ]
        last = 0
        for last, row in enumerate(rows, 1):
            cells = "".join([write(last + 1, cell) for write, cell in zip(writers, row, strict=True)])
            content.write(f'<row r="{last + 1}">{cells}</row>'.encode())
        return last

    def _looks(self, kind: Kind) -> Looks:
        """As the library counts them: a look is in the file once it has a number."""
        looks = (self._formats[kind], self._formats[Kind.TEXT], self._quoted)
        return Looks(*(look._get_xf_index() for look in looks))

    def _colour(self, sheet: Worksheet, columns: Sequence[Column], last: int) -> None:
        """Verdicts in their colours, as rules of the sheet: they follow when somebody sorts or edits. No word of one
        begins as another's does, and what is added to it, a reservation, changes no colour."""
        for place, column in enumerate(columns):
            if column.kind is Kind.VERDICT and last:
                for word, tone in self._tones.items():
                    rule = {"type": "text", "criteria": "begins with", "value": word, "format": tone}
                    sheet.conditional_format(1, place, last, place, rule)

    def close(self) -> None:
        """Writes the file."""
        with self._files:
            self._book.close()
            put_rows(self._made, self._rows, self._target)
