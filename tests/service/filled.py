"""A template as somebody fills it in: the readings of its example, and what is asked."""

from collections.abc import Mapping
from io import BytesIO

import fastexcel
import xlsxwriter

Cell = str | float | None


def cells(content: bytes, name: str) -> list[list[Cell]]:
    """The rows of a sheet, numbers as numbers."""
    book = fastexcel.read_excel(content)
    texts, numbers = (
        book.load_sheet(name, header_row=None, dtypes=kind).to_polars().rows() for kind in ("string", "float")
    )
    return [
        [text if number is None else number for text, number in zip(*row, strict=True)]
        for row in zip(texts, numbers, strict=True)
    ]


def filled(template: bytes, asked: Mapping[str, Cell], count: int | None = None) -> bytes:
    """The two sheets of a session with every empty cell of ``count`` rows (None: of all) filled in, under the names
    that they have; what is asked and has no row gets one."""
    keys, table, shown = fastexcel.read_excel(template).sheet_names
    session = [[row[0], asked.get(str(row[0]), row[1])] for row in cells(template, keys)]
    session += [[key, value] for key, value in asked.items() if key not in {row[0] for row in session}]
    readings, example = cells(template, table), cells(template, shown)
    for k in range(len(readings[0])):
        for row, like in list(zip(readings[1:], example[1:], strict=True))[:count]:
            row[k] = like[k] if row[k] is None else row[k]
    buffer = BytesIO()
    with xlsxwriter.Workbook(buffer) as book:
        for name, rows in ((keys, session), (table, readings)):
            sheet = book.add_worksheet(name)
            for j, row in enumerate(rows):
                sheet.write_row(j, 0, row)
    return buffer.getvalue()
