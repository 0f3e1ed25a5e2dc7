"""XLSX: sheet `readings` with a header row, sheet `session` with keys and values such as `sensors[1].name` | A1."""

from typing import Literal

import fastexcel
import numpy as np
import polars as pl

from estimator.reading.columns import Column
from estimator.reading.csv_text import named_columns
from estimator.reading.problems import Problems
from service.ingest.key_values import TEXTS, last_step, nested
from service.ingest.limits import in_force, refusal
from service.ingest.workbook import check_workbook

BOOLEANS = ("true", "false")
"""How the library writes a cell that is true or false, which as a number would be 1 or 0."""
DType = Literal["string", "float"]
Cell = float | str | None
SHEETS = ("session", "readings")
"""That a session needs."""


def read_xlsx(content: bytes, filename: str) -> dict[str, object]:
    """The document that a workbook holds."""
    check_workbook(content, filename)
    session, readings = _sheets(content, filename)
    problems = Problems(filename, in_force().extent)
    document = nested(session, problems)
    table = named_columns(*readings, problems)
    problems.raise_if_any()
    return document | {"table": table}


def _sheets(content: bytes, filename: str) -> tuple[list[tuple[str, Cell]], tuple[list[str], list[Column]]]:
    """Keys and values of `session`; header and columns of `readings`."""
    try:
        book = fastexcel.read_excel(content)
        missing = [name for name in SHEETS if name not in book.sheet_names]
        found = None if missing else (_key_values(book), _table(book))
    except fastexcel.FastExcelError as error:
        raise refusal(filename, "is damaged or not a readable XLSX file; save it again") from error
    if found is None:
        raise refusal(filename, f"has no sheet {' and no sheet '.join(missing)}; a session needs both")
    return found


def _key_values(book: fastexcel.ExcelReader) -> list[tuple[str, Cell]]:
    texts = _load(book, "session", "string").get_columns()
    if len(texts) < 2:
        return []
    values = _cells(_load(book, "session", "float").get_columns()[1], texts[1])
    rows = zip(texts[0].to_list(), values, texts[1].to_list(), strict=True)
    return [(key, text if last_step(key) in TEXTS else value) for key, value, text in rows if key]


def _table(book: fastexcel.ExcelReader) -> tuple[list[str], list[Column]]:
    """Without the empty rows that a spreadsheet keeps at its end."""
    texts, numbers = _load(book, "readings", "string"), _load(book, "readings", "float")
    if texts.is_empty():
        return [], []
    header = [text or "" for text in texts.row(0)]
    ends = [np.flatnonzero(series.is_not_null().to_numpy()) for series in texts.slice(1)]
    count = max((int(rows[-1]) + 1 for rows in ends if len(rows)), default=0)
    pairs = zip(numbers.slice(1, count), texts.slice(1, count), strict=True)
    return header, [_cells(*pair) for pair in pairs]


def _load(book: fastexcel.ExcelReader, sheet: str, dtype: DType) -> pl.DataFrame:
    """The cells of a sheet, every one as this type or null."""
    return book.load_sheet(sheet, header_row=None, dtypes=dtype).to_polars()


def _cells(numbers: pl.Series, texts: pl.Series) -> Column:
    """Numbers where a cell is one, else its text. As text, the library rounds numbers to nine decimals."""
    is_number = numbers.is_not_null() & ~texts.is_in(BOOLEANS).fill_null(False)
    if is_number.all():
        return numbers.to_numpy()
    known = numbers.to_list()
    return [known[j] if sure else text for j, (sure, text) in enumerate(zip(is_number, texts, strict=True))]
