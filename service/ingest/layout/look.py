"""Preview of a file before anything is decided: headings, first cells, the words of its columns."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from estimator.json_object import Json
from estimator.message import say
from service.ingest import hdf5, mat, parquet
from service.ingest.formats import HDF5, JSON, LOGS, MAT, PARQUET, XLSX, is_binary
from service.ingest.layout.cutting import Cell, separator_of
from service.ingest.layout.decoding import NO_TEXT, encoding_of
from service.ingest.layout.envelope import is_wrapped
from service.ingest.layout.grids import Grid, grid_of, is_nothing, number_of
from service.ingest.layout.mapping import layout_of
from service.ingest.layout.pivoting import side_by_side
from service.ingest.layout.reading import word_text
from service.ingest.layout.sampling import Sample
from service.ingest.layout.times import seconds_of
from service.ingest.xlsx import session_sheets, sheet_names
from service.kit.limits import refusal

SHOWN = 5
"""First cells of a column that are shown."""
MOST_COLUMNS = 300
"""Columns that a mapping can have; a table with more is another matter."""
MOST_WORDS = 12
"""Distinct texts of a column of labels."""
LONGEST_CELL = 60
"""Characters of a cell that are shown."""
MOST_VALUES = 20_000
"""First values of a column that are looked at for its meaning: some minutes of a log."""
MOST_CELLS = 400_000
"""Values that are looked at, of all columns together."""
LINES = 12
"""First lines that are shown of a text that cannot be cut."""
FEWEST_ROWS = 2
"""Lines with a number; text with fewer is no table."""
START = 32
"""Bytes from which a binary format is recognised."""
MOSTLY = 0.5
"""Share of numbers from which a column counts as numeric."""


def is_session(content: bytes, filename: str) -> bool:
    """Whether a file claims to be imu-session/1, rightly or wrongly, or cannot be a table at all. Of a text the
    beginning is enough."""
    if is_wrapped(content):
        return True
    if content.startswith(XLSX):
        return session_sheets(sheet_names(content, filename)) is not None
    if content.startswith(LOGS):
        return False
    if content.startswith(PARQUET):
        return parquet.has_metadata(content)
    if content.startswith(HDF5):
        return hdf5.has_metadata(content, filename)
    if content.startswith(MAT):
        return mat.has_metadata(content, filename)
    head = content[:4096].lstrip(b"\xef\xbb\xbf \t\r\n")
    return not head or JSON.match(head) is not None or (head[:1] == b"#" and head.lstrip(b"# \t")[:1] == b"{")


def look(content: bytes | Sample, filename: str, mapping: Json | None = None) -> object:
    """Preview of a table, with the settings of its mapping where it has one."""
    stated = {} if mapping is None else layout_of(mapping, filename).table
    if is_session(content.head if isinstance(content, Sample) else content, filename):
        return {"session": True}
    grid = side_by_side(grid_of(content, filename, stated))
    if len(grid.headings) > MOST_COLUMNS:
        parts = {"headings": len(grid.headings), "most_columns": MOST_COLUMNS}
        text = say("has {headings} columns; a mapping takes at most {most_columns}; remove those not needed", **parts)
        raise refusal(filename, text, "table")
    return {
        "session": False,
        "kind": grid.kind,
        "taken": dict(grid.taken),
        "sheets": list(grid.sheets),
        "rows": grid.rows,
        "sampled": isinstance(content, Sample),
        "columns": [_column(heading, cells, grid) for heading, cells in zip(grid.headings, grid.columns, strict=True)],
        "facts": dict(grid.facts),
        "titles": dict(grid.titles),
        "lines": [],
    }


def lines(content: bytes, filename: str, mapping: Json | None = None) -> object:
    """Beginning of a text that cannot be cut as it is understood, with the settings to be corrected."""
    stated = {} if mapping is None else layout_of(mapping, filename).table
    if is_binary(content[:START]) or is_session(content, filename):
        raise refusal(filename, NO_TEXT)
    encoding = str(stated.get("encoding") or encoding_of(content))
    text = content.decode(encoding, "replace").lstrip("\ufeff")
    if sum(any(sign.isdecimal() for sign in line) for line in text.splitlines()) < FEWEST_ROWS:
        raise refusal(filename, NO_TEXT)
    settings = {"encoding": encoding, "separator": separator_of(text), "decimal": ".", "header_row": 0, "first_row": 1}
    return {
        "session": False,
        "kind": "text",
        "taken": settings | dict(stated),
        "sheets": [],
        "rows": 0,
        "sampled": False,
        "columns": [],
        "facts": {},
        "titles": {},
        "lines": [_shown(line) for line in text.splitlines()[:LINES]],
    }


def _column(heading: str, cells: Any, grid: Grid) -> Json:
    decimal = str(grid.taken.get("decimal", "."))
    following = len(cells) if grid.following is None else grid.following
    following -= sum(j < following for j in grid.skipped)
    cells = [cell for j, cell in enumerate(cells) if j not in grid.skipped]
    filled = [cell for cell in cells if not is_nothing(cell)]
    first_cells = cells[: min(following, MOST_VALUES, MOST_CELLS // len(grid.headings))]
    values: list[Cell] = [None if is_nothing(cell) else number_of(cell, decimal) for cell in first_cells]
    numbers = sum(value is not None for value in values)
    holds_numbers = bool(filled) and numbers >= MOSTLY * sum(not is_nothing(cell) for cell in first_cells)
    if not holds_numbers and any(not isinstance(time, str) for time in seconds_of(filled[:SHOWN])):
        values = seconds_of(first_cells)
    words = list(dict.fromkeys(word_text(cell)[:LONGEST_CELL] for cell in filled[:10_000]))
    first = next((j for j, cell in enumerate(cells) if not is_nothing(cell)), len(cells))
    return {
        "heading": heading,
        "cells": [_shown(cell) for cell in cells[:SHOWN]],
        "numeric": holds_numbers,
        "empty": not filled,
        "words": words if len(words) <= MOST_WORDS else [],
        "holes": first == 0 and len(filled) < len(cells),
        "meaning": grid.meanings.get(heading),
        "values": _numbers(values),
    }


def _numbers(values: Sequence[Cell]) -> np.ndarray[Any, Any] | None:
    """The numbers, with NaN for others; None where there is none."""
    numbers = np.array([value if isinstance(value, float | int) else np.nan for value in values], dtype=float)
    return None if np.isnan(numbers).all() else numbers


def _shown(cell: Cell) -> str:
    text = f"{cell:.10g}" if isinstance(cell, float) else "" if cell is None else str(cell)
    return text if len(text) <= LONGEST_CELL else text[:LONGEST_CELL] + "…"
