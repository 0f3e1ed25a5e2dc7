"""The content of a session as tables of people's own layout, and the mapping that reads them."""

from collections.abc import Sequence
from io import BytesIO, StringIO
from typing import Any

import h5py
import numpy as np
import polars as pl
import xlsxwriter
from scipy.io import savemat

from tests import builders

Document = dict[str, Any]
HEADINGS = ("Прогон", "Угол, град", "Температура (°C)", "Датчик 1, мВ", "Датчик 2, мВ", "Датчик 3, мВ")
ENGLISH = ("Run", "BETA [deg]", "Temp (°C)", "acc 1, mV", "acc_2 [mV]", "A3 mV")
RUNS = {"direct": "прямой", "flipped": "обратный"}


def own_document(**changes: Any) -> Document:
    """A session of three accelerometers without standard errors, at a constant temperature."""
    document = builders.accelerometer_block(3)
    table = document["table"]
    kept = {name: table[name] for name in ("run", "beta_deg", "A1", "A2", "A3")}
    kept["temperature_c"] = [21.5] * len(kept["run"])
    for name in ("A1", "A2", "A3"):
        kept[name] = [round(cell, 7) for cell in kept[name]]
    return {**document, "table": kept, "started_at": "2026-03-01T09:00:00Z", **changes}


def rows_of(document: Document) -> list[list[Any]]:
    """The document's rows in mV, with Russian words for the runs."""
    table = document["table"]
    readings = ([round(1000 * cell, 4) for cell in table[name]] for name in ("A1", "A2", "A3"))
    columns = ([RUNS[run] for run in table["run"]], table["beta_deg"], table["temperature_c"], *readings)
    return [list(row) for row in zip(*columns, strict=True)]


def text_table(
    document: Document, headings: Sequence[str] = HEADINGS, *, separator: str = ";", decimal: str = ","
) -> str:
    """The table as a spreadsheet writes it where numbers have a decimal comma."""
    out = StringIO()
    out.write(separator.join(f'"{h}"' if separator in h else h for h in headings) + "\r\n")
    for row in rows_of(document):
        cells = (cell if isinstance(cell, str) else f"{cell:.10g}".replace(".", decimal) for cell in row)
        out.write(separator.join(cells) + "\r\n")
    return out.getvalue()


def xlsx_table(document: Document, headings: Sequence[str] = HEADINGS) -> bytes:
    """One sheet, headings in its first row."""
    buffer = BytesIO()
    with xlsxwriter.Workbook(buffer) as book:
        sheet = book.add_worksheet("Лист1")
        for j, row in enumerate([list(headings), *rows_of(document)]):
            sheet.write_row(j, 0, row)
    return buffer.getvalue()


def parquet_table(document: Document) -> bytes:
    """Named columns, without any metadata."""
    buffer = BytesIO()
    pl.DataFrame(rows_of(document), schema=list(HEADINGS), orient="row").write_parquet(buffer)
    return buffer.getvalue()


def hdf5_table(document: Document) -> bytes:
    """One dataset a column in the root."""
    buffer = BytesIO()
    with h5py.File(buffer, "w") as file:
        for name, cells in zip(
            ("run", "beta", "T degC", "A1 mV", "A2 mV", "A3 mV"), zip(*rows_of(document), strict=True), strict=True
        ):
            file[name] = list(cells) if isinstance(cells[0], str) else np.array(cells, float)
    return buffer.getvalue()


def mat_table(document: Document) -> bytes:
    """One variable a column."""
    names = ("run", "beta_deg", "T_C", "A1_mV", "A2_mV", "A3_mV")
    buffer = BytesIO()
    columns = dict(zip(names, map(np.array, zip(*rows_of(document), strict=True)), strict=True))
    savemat(buffer, columns, oned_as="column")
    return buffer.getvalue()


def facts_of(document: Document) -> Document:
    """Facts that no table states."""
    return {key: value for key, value in document.items() if key not in ("format", "table")}
