"""Text → rows of cells: the separator, separators behind each value, and files with several kinds of records."""

import csv
import io
import re
from collections import Counter
from collections.abc import Sequence

from service.kit.limits import refusal

Cell = str | float | None
SEPARATORS = (";", "\t", "|", ",")
"""Separators of columns, the unlikeliest within a cell first: a comma may be a decimal comma."""
BLANK = " "
SCANNED_ROWS = 60
"""Rows among which the headings are searched."""
EQUAL_SHARE = 0.8
"""Share of the first lines that a separator cuts into the same number of cells."""
BLANK_SHARE = 0.6
"""Share of the first lines that are numbers with blanks between them: titles and headings may be above."""
PLAIN_NUMBER = re.compile(r"[+\-−]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[eE][+\-]?\d+)?|nan", re.IGNORECASE)
QUOTED_OR_WORD = re.compile(r'"[^"]*"|[^\s\[(]+(?:\s*[\[(][^\])]*[\])]+)?|[\[(][^\])]*[\])]+')
"""A cell among blanks; a unit in brackets belongs to the word before."""
ENDINGS = (",", ";")
"""Signs that some loggers write behind each value, before the separator."""
MOST_RECORDS = 30
"""Kinds of records in one file."""
FEWEST_OF_A_KIND = 3
"""Records of a kind; fewer are titles."""
SIGNS = "$#!: "
"""Characters around the name of a record."""


def separator_of(text: str) -> str:
    """The separator of the first lines."""
    lines = [line for line in text[:100_000].split("\n")[:SCANNED_ROWS] if line.strip()]
    if _is_of_blanks(lines):
        return BLANK
    for separator in SEPARATORS:
        counts = [line.count(separator) for line in lines if separator in line]
        if counts and counts.count(count := max(counts, key=counts.count)) >= EQUAL_SHARE * len(lines) and count:
            return separator
    return max(SEPARATORS, key=text[:10_000].count)


def _is_of_blanks(lines: Sequence[str]) -> bool:
    """Whether most lines are numbers with blanks and nothing else between them, and alike in their number."""
    counts = [
        len(cells)
        for line in lines
        if "\t" not in line.strip() and (cells := line.split()) and all(map(PLAIN_NUMBER.fullmatch, cells))
    ]
    usual = max(counts, key=counts.count, default=0)
    return usual > 1 and counts.count(usual) >= BLANK_SHARE * len(lines)


def cut(text: str, separator: str, filename: str) -> list[list[Cell]]:
    """The rows of a text; FormatError where it cannot be cut there."""
    if separator == BLANK:
        rows: list[list[str]] = [_words(line) for line in text.split("\n")]
    else:
        try:
            rows = list(csv.reader(io.StringIO(text, newline=""), delimiter=separator[:1]))
        except (csv.Error, ValueError, TypeError) as error:
            said = "is not a table that can be cut at {separator}: {error}"
            raise refusal(filename, said, separator=repr(separator), error=error) from error
    while rows and not any(cell.strip() for cell in rows[-1]):
        rows.pop()
    ending = _ending(rows, separator)
    return [[cell.strip().removesuffix(ending).strip() or None for cell in row] for row in rows]


def _words(line: str) -> list[str]:
    cells = line.split()
    if any(sign in line for sign in '"[('):
        cells = [cell.strip('"') for cell in QUOTED_OR_WORD.findall(line)]
    return cells[1:] if cells[:1] in (["#"], ["%"], ["//"]) else cells


def _ending(rows: Sequence[Sequence[str]], separator: str) -> str:
    """Sign that follows each value beside the separator; empty where none does."""
    cells = [cell.strip() for row in rows[:SCANNED_ROWS] for cell in row if cell.strip()]
    for ending in ENDINGS:
        if ending != separator and sum(cell.endswith(ending) for cell in cells) >= EQUAL_SHARE * len(cells) > 0:
            return ending
    return ""


def record_of(rows: Sequence[Sequence[Cell]]) -> str:
    """The kind of record, stated in the first column, with most cells; empty where rows are of one kind.

    Kinds of records differ in length; each has a row of headings that begins like it, or names it in its second cell.
    """
    cells: Counter[str] = Counter()
    lengths: dict[str, Counter[int]] = {}
    for row in rows:
        name = _name(row)
        if name and sum(_is_number(cell) for cell in row[1:]) >= max(1, (len(row) - 1) // 2):
            cells[name] += len(row)
            lengths.setdefault(name, Counter())[len(row)] += 1
    lengths = {name: usual for name, usual in lengths.items() if usual.total() >= FEWEST_OF_A_KIND}
    cells = Counter({name: cells[name] for name in lengths})
    is_mixed = 1 < len(cells) <= MOST_RECORDS and len({usual.most_common(1)[0][0] for usual in lengths.values()}) > 1
    is_whole = sum(usual.total() for usual in lengths.values()) >= len(rows) / 2
    return cells.most_common(1)[0][0] if is_mixed and is_whole else ""


def of_record(rows: Sequence[Sequence[Cell]], record: str) -> list[list[Cell]]:
    """The headings, units and readings of one kind of record without its name; longer rows of headings by their end."""
    own = [list(row[1:]) for row in rows if _name(row) == record]
    readings = readings_of(rows, record)
    width = Counter(map(len, readings)).most_common(1)[0][0] if readings else 0
    named = [
        list(row[-width:])
        for row in rows
        if len(row) > width + 1 and _name(row) != record and any(_name([cell]) == record for cell in row[1:-width])
    ]
    return named + [row for row in own if row not in readings] + readings


def readings_of(rows: Sequence[Sequence[Cell]], record: str) -> list[list[Cell]]:
    """The readings of one kind of record without its name."""
    return [list(row[1:]) for row in rows if _name(row) == record and any(map(_is_number, row[1:]))]


def _name(row: Sequence[Cell]) -> str:
    """The first cell as a name of a kind of record; empty where it is a number or nothing."""
    first = row[0] if row else None
    return first.strip(SIGNS) if isinstance(first, str) and not _is_number(first) else ""


def _is_number(cell: Cell) -> bool:
    return isinstance(cell, str) and PLAIN_NUMBER.fullmatch(cell) is not None
