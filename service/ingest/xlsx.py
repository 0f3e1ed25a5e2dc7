"""XLSX: sheet `readings` with a header row, sheet `session` with keys and values such as `sensors[1].name` | A1."""

from typing import Any, Literal

import fastexcel

from estimator.reading.columns import Column
from estimator.reading.csv_text import named_columns
from estimator.reading.problems import Problems
from service.ingest.key_values import TEXTS, last_step, nested
from service.ingest.limits import refusal
from service.ingest.workbook import checked_workbook

MAGIC = b"PK\x03\x04"
"""First bytes of a ZIP archive."""
BOOLEANS = ("true", "false")
"""How the library writes a cell that is true or false, which as a number would be 1 or 0."""
DType = Literal["string", "float"]
Cell = float | str | None
SHEETS = ("session", "readings")
"""That a session needs."""


def read_xlsx(content: bytes, filename: str) -> dict[str, object]:
    """The document that a workbook holds."""
    session, readings = _sheets(checked_workbook(content, filename), filename)
    problems = Problems(filename)
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
    texts = _load(book, "session", "string")
    if len(texts) < 2:
        return []
    values = _cells(_load(book, "session", "float")[1], texts[1])
    rows = zip(texts[0], values, texts[1], strict=True)
    return [(key, text if last_step(key) in TEXTS else value) for key, value, text in rows if key]


def _table(book: fastexcel.ExcelReader) -> tuple[list[str], list[Column]]:
    texts = _load(book, "readings", "string")
    numbers = _load(book, "readings", "float")
    header = [(column[0] or "") if column else "" for column in texts]
    columns = [_cells(*pair)[1:] for pair in zip(numbers, texts, strict=True)]
    filled = max((row for column in columns for row, cell in enumerate(column, 1) if cell is not None), default=0)
    return header, [column[:filled] for column in columns]


def _load(book: fastexcel.ExcelReader, sheet: str, dtype: DType) -> list[list[Any]]:
    """The columns of a sheet, every cell as this type or None."""
    frame = book.load_sheet(sheet, header_row=None, dtypes=dtype).to_polars()
    return [series.to_list() for series in frame]


def _cells(numbers: list[float | None], texts: list[str | None]) -> list[Cell]:
    """Numbers where a cell is one, else its text. As text, the library rounds numbers to nine decimals."""
    return [text if number is None or text in BOOLEANS else number for number, text in zip(numbers, texts, strict=True)]
