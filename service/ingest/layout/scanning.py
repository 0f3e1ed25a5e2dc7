"""A long text under a mapping, some rows at a time: polars reads what is plain, and the rest is cut as a short text."""

import json
from codecs import getincrementaldecoder
from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import polars as pl
from numpy.typing import NDArray

from estimator.message import say
from estimator.reading.problems import shown
from service.ingest.apart import progress_reporter
from service.ingest.formats import is_binary
from service.ingest.layout.cutting import BLANK, Cell, cut, readings_of
from service.ingest.layout.envelope import StoredTable
from service.ingest.layout.grids import NOTHING, Grid, grid_of, is_nothing, is_title
from service.ingest.layout.mapping import ColumnMapping, Layout
from service.ingest.layout.pivoting import side_by_side
from service.ingest.layout.reading import FORMAT, WORDS, in_unit, read, require_own, start_of_time
from service.ingest.layout.sampling import sample_of
from service.ingest.layout.times import Before

TIME = "time_s"
READ = 1024 * 1024
"""Bytes that are read at a time."""
STRETCHES = 3
"""Stretches whose places in the file are known: a reader is one ahead of what is checked."""


def long_text(table: StoredTable, filename: str, layout: Layout) -> "TextRows | None":
    """The rows of a long text under a mapping; None of any other table. FormatError where the mapping is another's."""
    sample = None if is_binary(table.read(0, 32)) else sample_of(table)
    if sample is None:
        return None
    grid = grid_of(sample.first, filename, layout.table)
    if side_by_side(grid) is not grid:
        return None
    require_own(grid, layout, filename)
    mapped = tuple((k, column) for k, column in enumerate(layout.columns) if column.meaning)
    return TextRows(table, filename, layout, replace(grid, columns=()), sample.lines, mapped)


@dataclass
class TextRows:
    """Rows of readings of a text, in the columns and units of a session."""

    table: StoredTable
    filename: str
    layout: Layout
    grid: Grid
    """Table of its first rows."""
    lines: int
    mapped: Sequence[tuple[int, ColumnMapping]]
    """Columns of a session with their places."""
    places: deque[tuple[int, NDArray[np.int64]]] = field(default_factory=lambda: deque(maxlen=STRETCHES))
    """Number of the first row, and lines of the rows, of the last stretches."""

    @property
    def metadata(self) -> str:
        """The facts of the session."""
        return json.dumps({**self.layout.session, "format": FORMAT})

    @property
    def names(self) -> Sequence[str]:
        """Columns of the session."""
        return [str(column.meaning) for _, column in self.mapped]

    def count(self, most: int) -> int:
        """Number of lines of readings, of all kinds."""
        return self.lines - self._first

    @property
    def _first(self) -> int:
        return 0 if self.grid.taken.get("record") else int(self.grid.taken["first_row"]) - 1

    def where(self, field: str, row: int | None) -> str:
        """Column and line of a cell of the stretches that were read last."""
        column = next((column for _, column in self.mapped if column.meaning == field), None)
        if column is None or row is None:
            return ""
        line = next((lines[row - 1 - at] for at, lines in self.places if 0 <= row - 1 - at < len(lines)), None)
        said = say("column {heading}", heading=shown(column.heading))
        return said if line is None else say("{column}, line {line} of the file", column=said, line=line)

    def stretches(self, names: Sequence[str]) -> Iterator[pl.DataFrame]:
        """Some columns, some rows at a time."""
        before, rows, lines = Before(), 0, 0
        self.places.clear()
        for text in self._texts():
            count, skipped = text.count("\n"), max(self._first - lines, 0)
            text = "\n".join(text.split("\n")[skipped:])
            frame, kept = self._plain(text, before) or self._cut(text, before)
            self.places.append((rows, kept + (lines + skipped + 1)))
            rows, lines = rows + len(frame), lines + count
            yield frame.select(names)

    def _texts(self) -> Iterator[str]:
        """Whole lines."""
        decoder, rest = getincrementaldecoder(self.grid.taken["encoding"])("replace"), ""
        for at in range(0, self.table.size, READ):
            is_last = at + READ >= self.table.size
            text = rest + decoder.decode(self.table.read(at, READ), final=is_last)
            whole = text if is_last else text[: text.rfind("\n") + 1]
            rest = text[len(whole) :]
            yield whole.replace("\r\n", "\n").lstrip("\ufeff")
            progress_reporter().report(min(at + READ, self.table.size), self.table.size)

    def _plain(self, text: str, before: Before) -> tuple[pl.DataFrame, NDArray[np.int64]] | None:
        """Rows of numbers, and of labels, that need no care; None of others, with nothing read."""
        separator = str(self.grid.taken["separator"])
        if self.grid.taken.get("record") or any(column.fill_down for _, column in self.mapped):
            return None
        if separator == BLANK:
            text = "\n".join([" ".join(line.split()) for line in text.split("\n")])
        kinds = {str(k): pl.String for k in range(len(self.grid.headings))}
        try:
            scan = pl.scan_csv(
                text.encode(), has_header=False, separator=separator, schema=kinds, infer_schema=False,
                truncate_ragged_lines=True,
            )  # fmt: skip
            cells = scan.select(str(k) for k, _ in self.mapped).collect()
        except pl.exceptions.PolarsError:
            return None
        if '"' in text and len(cells) != sum(bool(line.strip()) for line in text.split("\n")):
            return None
        columns: dict[str, pl.Series] = {}
        for k, column in sorted(self.mapped, key=lambda one: one[1].meaning == TIME):  # the others may be no plain ones
            texts = cells[str(k)].str.strip_chars()
            texts = texts.set(texts.str.to_lowercase().is_in(NOTHING), None)
            series = self._labels(texts, column) if column.meaning in WORDS else self._numbers(texts, column, before)
            if series is None:
                return None
            columns[str(column.meaning)] = series
        frame = pl.DataFrame(columns)
        is_row = ~frame.select(pl.all_horizontal(pl.all().is_null())).to_series()
        return frame.filter(is_row), np.flatnonzero(is_row.to_numpy())

    def _numbers(self, texts: pl.Series, column: ColumnMapping, before: Before) -> pl.Series | None:
        """Numbers in the unit of the session; None where not all are."""
        decimal = str(self.grid.taken["decimal"])
        pointed = texts.str.replace_all(",", ".", literal=True) if decimal == "," else texts
        numbers = pointed.cast(pl.Float64, strict=False)
        if numbers.null_count() == texts.null_count():
            first = numbers.drop_nulls().head(1).to_list()
            start = start_of_time(first[0] if first else None, column, self.layout, before)
            times, over, offset = in_unit(column, self.layout)
            return (numbers - start) * times / over + offset
        if column.meaning != TIME or numbers.null_count() < len(numbers):
            return None
        return _series(read(texts.to_list(), column, self.layout, decimal, before))

    def _labels(self, texts: pl.Series, column: ColumnMapping) -> pl.Series:
        """Names of positions or runs."""
        different = texts.unique(maintain_order=True).to_list()
        named = read(different, column, self.layout, ".", Before())
        return texts.replace_strict(different, named, return_dtype=pl.String)

    def _cut(self, text: str, before: Before) -> tuple[pl.DataFrame, NDArray[np.int64]]:
        """Rows of any kind, cut as a short text is."""
        taken = self.grid.taken
        rows = cut(text, str(taken["separator"]), self.filename)
        lines = list(range(len(rows)))
        if taken.get("record"):
            lines = [j for j in lines if readings_of(rows[j : j + 1], str(taken["record"]))]
            rows = readings_of(rows, str(taken["record"]))
        width = len(self.grid.headings)
        rows = [row + [None] * (width - len(row)) for row in rows]
        kept = [
            j
            for j, row in enumerate(rows)
            if any(not is_nothing(row[k]) for k, _ in self.mapped)
            and row not in self.grid.repeated
            and not is_title(row)
        ]
        decimal = str(taken["decimal"])
        columns = {
            str(column.meaning): _series(read([rows[j][k] for j in kept], column, self.layout, decimal, before))
            for k, column in self.mapped
        }
        return pl.DataFrame(columns), np.array([lines[j] for j in kept], dtype=np.int64)


def _series(cells: Sequence[Cell]) -> pl.Series:
    """Numbers, or texts where any is no number."""
    if any(isinstance(cell, str) for cell in cells):
        return pl.Series([None if cell is None else str(cell) for cell in cells], dtype=pl.String)
    return pl.Series(cells, dtype=pl.Float64)
