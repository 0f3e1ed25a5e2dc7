"""CSV with metadata → a document: leading lines with # hold the JSON of the session without its table.

The table follows as ordinary CSV: one header row, one line a row, an empty cell where nothing is stated. Without
leading # lines the metadata stands in a JSON file of the same name beside it.
"""

import csv
import math
from collections.abc import Iterator
from itertools import takewhile

import numpy as np

from estimator.message import say
from estimator.reading.columns import Column
from estimator.reading.json_text import parse_json
from estimator.reading.problems import Problems, shown
from estimator.reading.shape import check_extent
from estimator.wording import counted

SEPARATORS = ",;\t"
"""Separators of cells; the most frequent one in the header is taken."""
BLOCK = 1024 * 1024
"""Characters that are taken apart at a time."""
ADVICE = "put the session's JSON without its table before the header, each line starting with #"
"""Advice to somebody who gives a table without metadata."""


def parse_csv(text: str, problems: Problems, sidecar: str | None = None) -> dict[str, object]:
    """The document of a CSV text, with the metadata of its # lines or else of the ``sidecar``'s JSON text."""
    text = text.replace("\r\n", "\n").replace("\r", "\n").rstrip("\n ")
    leading = list(takewhile(lambda line: line.startswith("#") or not line.strip(), _lines(text)))
    metadata = "\n".join(line[1:] for line in leading)
    if not metadata.strip():
        if sidecar is None:
            raise problems.fail("file", "is a CSV table without metadata; {advice}", advice=ADVICE)
        metadata = sidecar
    document = parse_json(metadata, problems)
    if "table" in document:
        problems.add("table", "is in the metadata of a CSV file; keep the readings in the CSV rows only")
    problems.lines_before_table = len(leading) + 1
    return document | {"table": _parse_table(text, sum(len(line) + 1 for line in leading), problems)}


def _lines(text: str) -> Iterator[str]:
    """Line after line, without their ends."""
    at = 0
    while at <= len(text):
        end = text.find("\n", at)
        end = len(text) if end < 0 else end
        yield text[at:end]
        at = end + 1


def _blocks(text: str, at: int) -> Iterator[list[str]]:
    """The lines from a place on, some at a time: a line is ten times as large in memory as in the text."""
    while at < len(text):
        end = text.find("\n", at + BLOCK)
        end = len(text) if end < 0 else end
        yield text[at:end].split("\n")
        at = end + 1


def _parse_table(text: str, start: int, problems: Problems) -> dict[str, Column]:
    """Column name → cells of the lines from ``start`` on."""
    if start >= len(text):
        return {}
    end = text.find("\n", start)
    first = text[start:] if end < 0 else text[start:end]
    separator = max(SEPARATORS, key=first.count)
    check_extent(text.count("\n", start), first.count(separator) + 1, problems)
    header: list[str] = []
    parts: list[list[Column]] = []
    uneven: dict[int, int] = {}
    for lines in _blocks(text, start):
        rows = _rows(lines, separator, problems)
        if not header:
            header, rows = rows[0], rows[1:]
            parts = [[] for _ in header]
        done = sum(map(len, parts[0]))
        uneven |= {done + j: len(row) for j, row in enumerate(rows) if len(row) != len(header)}
        rows = [row if len(row) == len(header) else (row + [""] * len(header))[: len(header)] for row in rows]
        for k, cells in enumerate(parts):
            cells.append(_cells([row[k] for row in rows]))
    problems.add_rows(
        "table",
        uneven,
        lambda j: say(
            "has {uneven} where the header has {header}", uneven=counted(uneven[j], "cell"), header=len(header)
        ),
    )
    return named_columns(header, [_joined(cells) for cells in parts], problems)


def _rows(lines: list[str], separator: str, problems: Problems) -> list[list[str]]:
    """The cells of every line."""
    try:
        rows = list(csv.reader(lines, delimiter=separator))
    except csv.Error as error:
        raise problems.fail("file", "is not a readable CSV table: {error}", error=error) from error
    if len(rows) != len(lines) or lines[-1].count('"') % 2:
        raise problems.fail(
            "table", "a cell contains a line break, or a quote is not closed; keep each row on one line"
        )
    return rows


def _joined(parts: list[Column]) -> Column:
    """One column; the parts are given up."""
    whole: Column
    arrays = [part for part in parts if isinstance(part, np.ndarray)]
    if parts and len(arrays) == len(parts):
        whole = np.concatenate(arrays)
    else:
        whole = [cell for part in parts for cell in (part.tolist() if isinstance(part, np.ndarray) else part)]
    parts.clear()
    return whole


def named_columns(header: list[str], columns: list[Column], problems: Problems) -> dict[str, Column]:
    """Name → column; a nameless column is tolerated when it is empty (a separator at the end of every line)."""
    check_extent(0, len(header), problems)
    table: dict[str, Column] = {}
    for number, (name, cells) in enumerate(zip(map(str.strip, header), columns, strict=True), start=1):
        if name in table:
            problems.add(name, "two columns of the header are named {name}; names must differ", name=shown(name))
        elif name:
            table[name] = cells
        elif any(cell is not None for cell in cells):
            problems.add("table", "column {number} has no name in the header; name it", number=number)
    return table


def _cells(texts: list[str]) -> Column:
    """A column's cells; all numbers in one pass, else cell by cell."""
    try:
        numbers = np.fromiter(map(float, texts), np.float64, len(texts))
    except ValueError:
        return [cell_of(text) for text in texts]
    exact = np.isfinite(numbers).all() and not any("_" in text for text in texts)
    return numbers if exact else [cell_of(text) for text in texts]


def cell_of(text: str) -> object:
    """The value of one text: a number, the text itself, or None when it is empty."""
    text = text.strip()
    if not text:
        return None
    try:
        number = float(text)
    except ValueError:
        return text
    return text if "_" in text or not math.isfinite(number) else number
