"""The table of the tutorial: a bench's own layout, three accelerometers in mV; the zero of A2 runs away meanwhile."""

from datetime import datetime
from io import BytesIO
from typing import Any

import numpy as np
import xlsxwriter

from tests.builders import Document, accelerometer_block

HEADINGS = ("Run", "Angle, deg", "Time, s", "Temp (°C)", "Channel 1, mV", "Channel 2, mV", "Channel 3, mV")
NAMES = ("A1", "A2", "A3")
RUNAWAY = 120e-6 * 9.80665
"""m/s², from the first row to the last."""
FACTS = {
    "Serial number of the unit": "MY-001",
    "Measured on": "2026-03-01",
    "Stand: name or number": "bench 3",
    "Elevation of the head's axis": "40",
    "Latitude": "55.81",
    **{f"{name}: scale factor": "0.12" for name in NAMES},
    **{f"{name}: unit of readings": "V" for name in NAMES},
}
"""Answers of the tutorial to the questions of the page."""


def session() -> Document:
    """The session as a file of ours would say it."""
    document = accelerometer_block(3, positions=24, unit="MY-001", seed=4)
    table = document["table"]
    rows = len(table["run"])
    scale = document["sensors"][1]["nominal_scale"]
    table["A2"] = (np.array(table["A2"]) + scale * RUNAWAY * np.linspace(0, 1, rows)).tolist()
    table["time_s"] = [30.0 * row for row in range(rows)]
    table["temperature_c"] = [21.5] * rows
    return document


def rows() -> list[list[Any]]:
    """The rows as the bench writes them."""
    table = session()["table"]
    readings = ([round(1000 * cell, 4) for cell in table[name]] for name in NAMES)
    columns = (table["run"], table["beta_deg"], table["time_s"], table["temperature_c"], *readings)
    return [list(HEADINGS), *(list(row) for row in zip(*columns, strict=True))]


def workbook() -> bytes:
    """One sheet."""
    buffer = BytesIO()
    with xlsxwriter.Workbook(buffer) as book:
        book.set_properties({"created": datetime(2026, 3, 1)})
        sheet = book.add_worksheet("bench 3")
        sheet.set_column(0, len(HEADINGS) - 1, 14)
        for place, row in enumerate(rows()):
            sheet.write_row(place, 0, row)
    return buffer.getvalue()
