"""Any table → columns of cells with their headings, and the settings of the parser."""

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import fastexcel
import numpy as np
import polars as pl
from numpy.typing import NDArray

from estimator.message import say
from estimator.screening import Screening
from service.ingest import hdf5, logs, mat, parquet
from service.ingest.foreign import require_table
from service.ingest.formats import HDF5, MAT, PARQUET, XLSX
from service.ingest.layout.cutting import SCANNED_ROWS, Cell, cut, of_record, readings_of, record_of, separator_of
from service.ingest.layout.decoding import decoded
from service.ingest.layout.sampling import Sample
from service.ingest.layout.titles import stated_in
from service.ingest.layout.understand import joined, split_unit
from service.ingest.layout.vocabulary import unit_of
from service.ingest.xlsx import BOOLEANS, check_workbook, letters_of
from service.kit.limits import check_table, refusal

NUMBER = re.compile(r"^[+\-−]?[\d \u00a0\u202f']*[.,]?\d+(?:[eEЕ][+\-]?\d+)?$|^[+\-−]?\d+[.,]$")
"""A number with a decimal point or comma, and spaces between thousands."""
DECIMAL_COMMA = re.compile(r"^[+\-−]?[\d \u00a0\u202f]*,\d+(?:[eE][+\-]?\d+)?$")
FEWEST = 2
"""Columns of a table: text with one column is no table, or has another separator."""
LONGEST_NUMBER = 40
"""Characters of a number, spaces included."""
COMMENT = re.compile(r"^(?:#|%|//)+\s*(?=\w)")
"""Signs of a comment before a heading."""
LONGEST_HEADING = 200
"""Characters of a heading that are examined and kept."""
SPACES = re.compile(r"[ \u00a0\u202f']")
NOTHING = ("", "-", "–", "—", "nan", "none", "null", "n/a", "na", "нет")
"""CellKind that count as empty."""


@dataclass(frozen=True)
class Grid:
    """A table as cells: R rows of readings, each column with its heading."""

    kind: str
    """text, xlsx, parquet, hdf5, mat or log."""
    headings: tuple[str, ...]
    columns: tuple[Sequence[Cell], ...]
    """Cells as written: numbers where the file has numbers, else texts, None where empty."""
    taken: Mapping[str, Any]
    """Settings of the parser: encoding, separator, decimal, sheet, header_row, first_row."""
    sheets: tuple[str, ...] = ()
    meanings: Mapping[str, str] = field(default_factory=dict)
    """Meanings of its columns stated in the file, by heading."""
    facts: Mapping[str, Any] = field(default_factory=dict)
    """Facts of the session stated in a log."""
    titles: Mapping[str, Any] = field(default_factory=dict)
    """Facts of the session stated in the rows above a table."""
    screening: Screening = ()
    """Findings in the samples of a log before they were put into rows."""
    skipped: frozenset[int] = frozenset()
    """Rows, from 0, that repeat the headings or are a title among the readings."""
    following: int | None = None
    """Rows that follow one another, of a sample; None where all rows are here."""
    repeated: Sequence[Sequence[Cell]] = ()
    """Rows of its headings, which may come again below."""
    lines: Sequence[int] = ()
    """Lines of the rows; empty where they follow one another from the first."""
    unseen: int = 0
    """Rows of the file that are not here."""

    @property
    def rows(self) -> int:
        """Number of rows of readings."""
        return max(map(len, self.columns), default=0) + self.unseen

    def place(self, column: int, row: int) -> str:
        """Place of a cell in the file; rows count from 1."""
        line = self.lines[row - 1] if self.lines else row + int(self.taken.get("first_row", 1)) - 1
        if self.kind == "xlsx":
            parts = {"column": letters_of(column + 1), "line": line, "taken": self.taken["sheet"]}
            return say("cell {column}{line} of the sheet {taken}", **parts)
        return say("line {line} of the file", line=line) if self.kind == "text" else ""


def grid_of(content: bytes | Sample, filename: str, stated: Mapping[str, Any], declined: Collection[str] = ()) -> Grid:
    """The table in a file; ``stated``: the settings of ``taken`` that were chosen by hand; ``declined``: what a log is
    not screened for."""
    if isinstance(content, Sample):
        return _sampled(content, filename, stated)
    require_table(content, filename)
    if content.startswith(XLSX):
        return _workbook(content, filename, stated)
    for magic, read in ((PARQUET, _parquet), (HDF5, _hdf5), (MAT, _mat)):
        if content.startswith(magic):
            return read(content, filename)
    log = logs.log_of(content, filename, declined)
    if log is not None:
        grid = _named("log", log.columns)
        meanings = dict(zip(grid.headings, log.meanings, strict=True))
        return replace(grid, meanings=meanings, facts=log.facts, screening=log.screening)
    return _text(content, filename, stated)


def number_of(cell: Cell, decimal: str) -> float | None:
    """The number in a cell; None where it is not one."""
    if not isinstance(cell, str):
        return cell
    if len(cell) > LONGEST_NUMBER or not NUMBER.match(cell.strip()):
        return None
    text = SPACES.sub("", cell.strip()).replace("−", "-").replace("Е", "E")
    if decimal == ",":
        text = text.replace(".", "").replace(",", ".") if "," in text else text
    try:
        return float(text)
    except ValueError:
        return None


def is_nothing(cell: Cell) -> bool:
    """Whether a cell is empty or holds a word for nothing."""
    return cell is None or (isinstance(cell, str) and cell.strip().casefold() in NOTHING)


def _text(content: bytes, filename: str, stated: Mapping[str, Any], later: bytes = b"") -> Grid:
    """The table of a text; ``later``: lines from anywhere below."""
    text, encoding = decoded(content, filename, stated.get("encoding"))
    lines = text.replace("\r\n", "\n").replace("\r", "\n")
    separator = str(stated.get("separator") or separator_of(lines))
    rows = cut(lines, separator, filename)
    taken = {"encoding": encoding, "separator": separator}
    record = str(stated["record"]) if "record" in stated else record_of(rows)
    below = cut(later.decode(encoding, "replace").replace("\r", ""), separator, filename)
    if record or "record" in stated:
        taken["record"] = record
    if record:
        rows, below = of_record(rows, record), readings_of(below, record)
    following, rows = len(rows), [*rows, *below]
    check_table(filename, len(rows), max(map(len, rows), default=0))
    grid = _headed("text", rows, taken, stated, filename)
    return replace(grid, following=following - int(grid.taken["first_row"]) + 1) if below else grid


def _sampled(sample: Sample, filename: str, stated: Mapping[str, Any]) -> Grid:
    grid = _text(sample.head, filename, stated, sample.later)
    seen = sample.head.count(b"\n") + sample.later.count(b"\n")
    share = grid.rows / (seen - int(grid.taken["first_row"]) + 1) if grid.taken.get("record") else 1.0
    return replace(grid, unseen=round(share * (sample.lines - seen)))


def _workbook(content: bytes, filename: str, stated: Mapping[str, Any]) -> Grid:
    check_workbook(content, filename)
    try:
        book = fastexcel.read_excel(content)
        names = tuple(book.sheet_names)
        chosen = stated.get("sheet")
        frames = {name: _frames(book, name) for name in names if chosen in (None, name)}
    except fastexcel.FastExcelError as error:
        raise refusal(filename, "is damaged or not a readable XLSX file; save it again") from error
    if not frames:
        raise refusal(
            filename,
            "has no sheet {chosen}; choose one of {names}",
            "table.sheet",
            chosen=repr(chosen),
            names=", ".join(names),
        )
    name = max(frames, key=lambda name: (frames[name][2], _filled(frames[name][0])))
    texts, numbers, _ = frames[name]
    columns = [_cells(n, t) for n, t in zip(numbers, texts, strict=True)]
    rows = [list(row) for row in zip(*columns, strict=True)] if columns else []
    while rows and all(cell is None for cell in rows[-1]):
        rows.pop()
    return _headed("xlsx", rows, {"sheet": name}, stated, filename, names)


def _frames(book: fastexcel.ExcelReader, name: str) -> tuple[pl.DataFrame, pl.DataFrame, bool]:
    """The cells of a sheet as texts and as numbers, and whether it is visible."""
    sheet = book.load_sheet(name, header_row=None, dtypes="string", skip_whitespace_tail_rows=True)
    texts = sheet.to_polars()
    numbers = book.load_sheet(name, header_row=None, dtypes="float", skip_whitespace_tail_rows=True).to_polars()
    return texts, numbers.head(len(texts)), sheet.visible == "visible"


def _filled(frame: pl.DataFrame) -> int:
    return sum(len(series) - series.null_count() for series in frame)


def _cells(numbers: pl.Series, texts: pl.Series) -> list[Cell]:
    pairs = zip(numbers.to_list(), texts.to_list(), strict=True)
    return [text if number is None or text in BOOLEANS else number for number, text in pairs]


def _headed(
    kind: str,
    rows: list[list[Cell]],
    taken: Mapping[str, Any],
    stated: Mapping[str, Any],
    filename: str,
    sheets: tuple[str, ...] = (),
) -> Grid:
    width = max(map(len, rows), default=0)
    short = _short(rows[:SCANNED_ROWS]) if kind == "text" else ()
    rows = [row + [None] * (width - len(row)) for row in rows]
    first = int(stated.get("first_row") or _first_row(rows, short)) - 1
    if not 0 <= first < len(rows):
        raise refusal(
            filename,
            "has no row of numbers below its headings; a table has one for every position; state the row of the first",
            "table",
        )
    header = int(stated["header_row"]) if "header_row" in stated else _header_row(rows, first, short)
    headings = _headings(rows[header - 1 : first] if header else [], width)
    skipped = _skipped(rows, header, first, filename)
    columns = tuple([row[k] for row in rows[first:]] for k in range(width))
    if sum(any(not is_nothing(cell) for cell in cells) for cells in columns) < FEWEST:
        raise refusal(filename, "has a single column; a table has one for every sensor", "table")
    decimal = str(stated.get("decimal") or _decimal(columns))
    settings = {"decimal": decimal, "header_row": header, "first_row": first + 1}
    titles = stated_in(rows[: max(header - 1, 0)] if header else rows[:first])
    above = rows[header - 1 : first] if header else ()
    return Grid(kind, headings, columns, {**taken, **settings}, sheets, titles=titles, skipped=skipped, repeated=above)


def _skipped(rows: list[list[Cell]], header: int, first: int, filename: str) -> frozenset[int]:
    """Rows below the first that hold no readings: the headings again, or a single text; raises for another table."""
    headings = rows[header - 1 : first] if header else []
    for j in range(first + 1, len(rows) - 1):
        if _has_words(rows[j]) and rows[j] not in headings and _names_columns(rows, j) and _is_heading(rows[j]):
            text = say("has another table from row {row} on; put every table on a sheet of its own", row=j + 1)
            raise refusal(filename, text, "table")
    return frozenset(j - first for j in range(first, len(rows)) if rows[j] in headings or is_title(rows[j]))


def _has_words(row: Sequence[Cell]) -> bool:
    """Whether two cells at least begin as words: found quickly."""
    return sum(isinstance(cell, str) and cell[:1].isalpha() for cell in row) > 1


def _names_columns(rows: list[list[Cell]], j: int) -> bool:
    """Whether a row has texts, two at least, where the next has numbers."""
    pairs = zip(rows[j], rows[j + 1], strict=True) if j + 1 < len(rows) else ()
    return sum(_is_words(upper) and not _is_words(lower) and not is_nothing(lower) for upper, lower in pairs) > 1


def _is_words(cell: Cell) -> bool:
    return not is_nothing(cell) and number_of(cell, ",") is None


def is_title(row: Sequence[Cell]) -> bool:
    """Whether a row is one text alone."""
    filled = [cell for cell in row if not is_nothing(cell)]
    return len(filled) == 1 and _is_words(filled[0])


def _share(row: Sequence[Cell]) -> float:
    cells = [cell for cell in row if not is_nothing(cell)]
    return sum(number_of(cell, ",") is not None for cell in cells) / len(cells) if cells else 0.0


def _short(rows: Sequence[Sequence[Cell]]) -> frozenset[int]:
    """Rows of a text that end earlier than most: titles."""
    lengths = [len(row) for row in rows]
    usual = max(lengths, key=lengths.count, default=0)
    return frozenset(j for j, length in enumerate(lengths) if 1 < length < usual)


def _first_row(rows: list[list[Cell]], short: Collection[int]) -> int:
    """The first row, from 1, that is mostly numbers and as full as the rows after it; past the end if none."""
    counts = sorted(sum(not is_nothing(cell) for cell in row) for row in rows[:SCANNED_ROWS])
    usual = counts[len(counts) // 2] if counts else 0
    for j, row in enumerate(rows[:SCANNED_ROWS]):
        is_full = 2 * sum(not is_nothing(cell) for cell in row) >= usual
        if _share(row) >= 0.5 and is_full and j not in short and not _names_columns(rows, j):
            return j + 1
    return len(rows) + 1


def _header_row(rows: list[list[Cell]], first: int, short: Collection[int]) -> int:
    """The upper one of one or two rows of headings right above the readings, from 1; 0 where there is none. ``short``:
    rows of a text that end early, which are titles."""
    if first < 2 or (first - 2 in short and not _of_units(rows[first - 1])):
        return max(first, 0)
    above = rows[first - 2]
    has_two_rows = _is_heading(above) and (_of_units(rows[first - 1]) or _is_torn(above))
    return first - 1 if has_two_rows or _is_unit_of_group(above) else first


def _is_heading(row: Sequence[Cell]) -> bool:
    return sum(cell is not None for cell in row) > 1 and _share(row) < 0.5


def _of_units(row: Sequence[Cell]) -> bool:
    texts = [str(cell) for cell in row if not is_nothing(cell)]
    return bool(texts) and sum(unit_of(cell) is not None for cell in texts) >= 0.5 * len(texts)


def _is_torn(row: Sequence[Cell]) -> bool:
    """Whether headings of groups stand in merged cells, each over several columns."""
    return any(cell is None for cell in row[1:]) and row[0] is not None


def _is_unit_of_group(row: Sequence[Cell]) -> bool:
    """Whether one heading over several columns, and none over the first, says their unit."""
    texts = [cell for cell in row if cell is not None]
    return len(texts) == 1 and row[0] is None and split_unit(str(texts[0]))[1] != ""


def _headings(rows: Sequence[Sequence[Cell]], width: int) -> tuple[str, ...]:
    """One text a column: group, heading and unit below each other are joined."""
    if not rows:
        return tuple(say("column {k}", k=k + 1) for k in range(width))
    lower = rows[-1]
    parts = [list(row) for row in rows]
    for row in parts[:-1]:
        for k in range(1, width):
            if row[k] is None and lower[k] is not None and not _of_units(lower):
                row[k] = row[k - 1]
    columns = ([_written(row[k]) for row in parts if row[k] is not None] for k in range(width))
    return tuple(COMMENT.sub("", " ".join(_heading(names).split()))[:LONGEST_HEADING] for names in columns)


def _written(cell: Cell) -> str:
    """``1`` for 1.0."""
    return (f"{cell:.10g}" if isinstance(cell, float) else str(cell).strip())[:LONGEST_HEADING]


def _heading(names: Sequence[str]) -> str:
    """Heading of a column: the texts above each other, a unit last."""
    if len(names) > 1 and unit_of(names[-1]) is not None:
        unit = names[-1].strip("[]()")
        return f"{' '.join(names[:-1])} [{unit}]"
    return joined(" ".join(names[:-1]), names[-1]) if names else ""


def _decimal(columns: Sequence[Sequence[Cell]]) -> str:
    texts = [cell for cells in columns for cell in cells[:SCANNED_ROWS] if isinstance(cell, str)]
    commas = sum(bool(DECIMAL_COMMA.match(text[:LONGEST_NUMBER])) for text in texts)
    points = sum("." in text and number_of(text, ".") is not None for text in texts)
    return "," if commas > points else "."


def _parquet(content: bytes, filename: str) -> Grid:
    return _named("parquet", parquet.table_of(content, filename))


def _hdf5(content: bytes, filename: str) -> Grid:
    return _named("hdf5", hdf5.table_of(content, filename))


def _mat(content: bytes, filename: str) -> Grid:
    return _named("mat", mat.table_of(content, filename))


def _named(kind: str, table: Mapping[str, Any]) -> Grid:
    columns = tuple(_listed(cells) for cells in table.values())
    rows = max(map(len, columns), default=0)
    whole = {name: cells for name, cells in zip(table, columns, strict=True) if len(cells) == rows}
    single = [[name, cells[0]] for name, cells in zip(table, columns, strict=True) if len(cells) == 1]
    headings = tuple(name[:LONGEST_HEADING] for name in whole)
    return Grid(kind, headings, tuple(whole.values()), {"first_row": 1, "decimal": "."}, titles=stated_in(single))


def _listed(cells: Sequence[Cell] | NDArray[Any]) -> list[Cell]:
    listed: list[Cell] = cells.tolist() if isinstance(cells, np.ndarray) else list(cells)
    return listed
