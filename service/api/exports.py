"""Records as tables that other programs read: CSV and Parquet."""

import io
from collections.abc import Mapping, Sequence
from typing import Any
from urllib.parse import quote

import polars as pl
from fastapi import Response

from service.records.history import HistoryPoint
from service.records.unit import UnitSummary
from service.words.verdict import unit_in_words

TIME = pl.Datetime("us", "UTC")
"""Microseconds, as both databases keep them."""
HISTORY_COLUMNS = {
    "session": pl.String(), "at": TIME, "sensor": pl.String(), "kind": pl.String(), "parameter": pl.String(),
    "value": pl.Float64(), "u": pl.Float64(), "lower": pl.Float64(), "upper": pl.Float64(),
    "reference": pl.Float64(), "deviation": pl.Float64(), "expanded": pl.Float64(), "tolerance": pl.Float64(),
    "verdict": pl.String(), "is_reference": pl.Boolean(),
    "axis_x": pl.Float64(), "axis_y": pl.Float64(), "axis_z": pl.Float64(), "revision": pl.Int64(),
}  # fmt: skip
FLEET_COLUMNS = {
    "serial": pl.String(), "unit_type": pl.String(), "simulated": pl.Boolean(), "sessions": pl.Int64(),
    "last_session": pl.String(), "last_at": TIME, "verdict": pl.String(), "is_reference": pl.Boolean(),
    "reason": pl.String(),
    "worst_sensor": pl.String(), "worst_parameter": pl.String(), "margin": pl.Float64(),
    "diagnosis": pl.String(), "flags": pl.Int64(), "due": TIME, "lot": pl.String(),
    "said": pl.String(),
}  # fmt: skip
FORMULA = r"^[=+\-@\t\r]"
"""How a cell begins that a spreadsheet would work out instead of showing."""
NO_AXIS = (None, None, None)
"""Of a parameter that is a number."""


def history_table(points: Sequence[HistoryPoint]) -> pl.DataFrame:
    """One row a point; the axis as three columns."""
    rows = [vars(p) | dict(zip(("axis_x", "axis_y", "axis_z"), p.axis or NO_AXIS, strict=True)) for p in points]
    return _table(rows, HISTORY_COLUMNS)


def fleet_table(units: Sequence[UnitSummary]) -> pl.DataFrame:
    """One row a unit."""
    return _table([vars(unit) | {"said": unit_in_words(unit)} for unit in units], FLEET_COLUMNS)


def as_csv(table: pl.DataFrame, filename: str) -> Response:
    """A line of names, then one line a row; times in ISO 8601. No text can pass for a formula of a spreadsheet."""
    harmless = [_harmless(column.name) for column in table.iter_columns() if column.dtype == pl.String]
    text = table.with_columns(harmless).write_csv(datetime_format="%Y-%m-%dT%H:%M:%S%.6fZ")
    return as_file(text.encode(), "text/csv; charset=utf-8", filename)


def _harmless(column: str) -> pl.Expr:
    cell = pl.col(column)
    return pl.when(cell.str.contains(FORMULA)).then(pl.concat_str(pl.lit("'"), cell)).otherwise(cell).alias(column)


def as_parquet(table: pl.DataFrame, filename: str) -> Response:
    """Parquet."""
    target = io.BytesIO()
    table.write_parquet(target)
    return as_file(target.getvalue(), "application/vnd.apache.parquet", filename)


def _table(rows: Sequence[Mapping[str, Any]], columns: Mapping[str, pl.DataType]) -> pl.DataFrame:
    cells = {name: [_plain(row[name]) for row in rows] for name in columns}
    return pl.DataFrame(cells, schema=dict(columns))


def _plain(value: Any) -> Any:
    """A verdict is written as its text."""
    return str(value) if isinstance(value, str) else value


def as_file(content: bytes, media_type: str, filename: str) -> Response:
    """Bytes that a browser keeps as a file of this name."""
    disposition = f"attachment; filename*=UTF-8''{quote(filename, safe='')}"
    return Response(content, media_type=media_type, headers={"Content-Disposition": disposition})
