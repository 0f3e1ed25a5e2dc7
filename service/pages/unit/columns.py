"""The history of a unit as columns, for other programs."""

from collections.abc import Sequence
from typing import Any

import polars as pl

from service.sessions.records import HistoryPoint
from service.web.files import TIME, table_of

HISTORY_COLUMNS = {
    "session": pl.String(), "at": TIME, "sensor": pl.String(), "kind": pl.String(), "parameter": pl.String(),
    "value": pl.Float64(), "u": pl.Float64(), "lower": pl.Float64(), "upper": pl.Float64(),
    "reference": pl.Float64(), "deviation": pl.Float64(), "expanded": pl.Float64(), "tolerance": pl.Float64(),
    "verdict": pl.String(), "is_reference": pl.Boolean(),
    "axis_x": pl.Float64(), "axis_y": pl.Float64(), "axis_z": pl.Float64(), "revision": pl.Int64(),
    "at_ms": pl.Int64(), "unit": pl.String(),
}  # fmt: skip


NO_AXIS = (None, None, None)
"""Of a parameter that is a number."""


def history_table(serial: str, points: Sequence[HistoryPoint]) -> pl.DataFrame:
    """One row a point of a unit's history; the axis as three columns."""
    return table_of([_point_row(serial, point) for point in points], HISTORY_COLUMNS)


def _point_row(serial: str, point: HistoryPoint) -> dict[str, Any]:
    axis = dict(zip(("axis_x", "axis_y", "axis_z"), point.axis or NO_AXIS, strict=True))
    return vars(point) | axis | {"at_ms": point.at_ms, "unit": serial}
