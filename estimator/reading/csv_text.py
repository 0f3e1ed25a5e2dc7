"""CSV with metadata → a document: leading lines with # hold the JSON of the session without its table.

The table follows as ordinary CSV: one header row, one line a row, an empty cell where nothing is stated. Without
leading # lines the metadata stands in a JSON file of the same name beside it.
"""

import csv
import math
from itertools import takewhile

import numpy as np

from estimator.reading.columns import Column
from estimator.reading.json_text import parse_json
from estimator.reading.problems import Problems, shown
from estimator.reading.shape import MOST_COLUMNS, MOST_ROWS

SEPARATORS = ",;\t"
"""Of cells; the one that the header has most of."""
ADVICE = "put the session's JSON without its table before the header, each line starting with #"
"""To whoever gives a table without metadata."""


def parse_csv(text: str, problems: Problems, sidecar: str | None = None) -> dict[str, object]:
    """The document of a CSV text, with the metadata of its # lines or else of the ``sidecar``'s JSON text."""
    lines = text.replace("\r\n", "\n").replace("\r", "\n").rstrip("\n ").split("\n")
    leading = list(takewhile(lambda line: line.startswith("#") or not line.strip(), lines))
    metadata = "\n".join(line[1:] for line in leading)
    if not metadata.strip():
        if sidecar is None:
            raise problems.fail("file", f"is a CSV table without metadata; {ADVICE}")
        metadata = sidecar
    document = parse_json(metadata, problems)
    if "table" in document:
        problems.add("table", "stands in the metadata of a CSV file; keep the readings in the CSV rows only")
    problems.lines_before_table = len(leading) + 1
    return document | {"table": _parse_table(lines[len(leading) :], problems)}


def _parse_table(lines: list[str], problems: Problems) -> dict[str, Column]:
    """Column name → cells of the CSV lines."""
    if len(lines) - 1 > MOST_ROWS:
        raise problems.fail("table", f"has {len(lines) - 1} rows; at most {MOST_ROWS} can be read")
    if not lines:
        return {}
    separator = max(SEPARATORS, key=lines[0].count)
    try:
        header, *rows = csv.reader(lines, delimiter=separator)
    except csv.Error as error:
        raise problems.fail("file", f"is not a readable CSV table: {error}") from error
    if len(rows) != len(lines) - 1:
        raise problems.fail("table", "a cell holds a line break, or a quote is not closed; keep each row in one line")
    rows = _even(rows, len(header), problems)
    return named_columns(header, [_cells([row[k] for row in rows]) for k in range(len(header))], problems)


def _even(rows: list[list[str]], width: int, problems: Problems) -> list[list[str]]:
    """The rows, all as wide as the header; records those that are not."""
    uneven = [j for j, row in enumerate(rows) if len(row) != width]
    if not uneven:
        return rows
    problems.add_rows("table", uneven, lambda j: f"has {len(rows[j])} cells where the header has {width}")
    return [(row + [""] * (width - len(row)))[:width] for row in rows]


def named_columns(header: list[str], columns: list[Column], problems: Problems) -> dict[str, Column]:
    """Name → column; a nameless column is tolerated when it is empty (a separator at the end of every line)."""
    if len(header) > MOST_COLUMNS:
        raise problems.fail("table", f"has {len(header)} columns; at most {MOST_COLUMNS} can be read")
    table: dict[str, Column] = {}
    for number, (name, cells) in enumerate(zip(map(str.strip, header), columns, strict=True), start=1):
        if name in table:
            problems.add(name, f"is the name of two columns of the header, {shown(name)}; names must differ")
        elif name:
            table[name] = cells
        elif any(cell is not None for cell in cells):
            problems.add("table", f"column {number} has no name in the header; name it")
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
    """What one text says: a number, the text itself, or None when it is empty."""
    text = text.strip()
    if not text:
        return None
    try:
        number = float(text)
    except ValueError:
        return text
    return text if "_" in text or not math.isfinite(number) else number
