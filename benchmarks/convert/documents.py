"""Parts of session files that several converters write."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from benchmarks.convert.contract import Document

Columns = NDArray[np.float64]

PER_DEGREE = 180 / np.pi
"""Readings per degree → readings per radian."""


def sensor(name: str, axis: Sequence[float], scale: float, unit: str, *, gyro: bool = False) -> Document:
    """One sensor; ``scale`` in reading units per m/s² or rad/s."""
    entry: Document = {
        "name": name,
        "nominal_axis": [float(x) for x in axis],
        "nominal_scale": scale,
        "reading_unit": unit,
    }
    return entry | {"kind": "gyroscope"} if gyro else entry


def triad(prefix: str, scale: float, unit: str, *, gyro: bool = False, axes: Columns | None = None) -> list[Document]:
    """Three sensors ``<prefix>x``, ``y``, ``z`` along the block's axes, or along the rows of ``axes``."""
    rows = np.eye(3) if axes is None else axes
    return [
        sensor(f"{prefix}{letter}", row, scale, unit, gyro=gyro)
        for letter, row in zip("xyz", rows.tolist(), strict=True)
    ]


def session(
    unit: str, sensors: list[Document], table: dict[str, list[object]], *, gravity: float, notes: str, **more: object
) -> Document:
    """A session of a block in arbitrary orientations."""
    return {
        "format": "imu-session/1",
        "unit": unit,
        "block": "accelerometer",
        "programme": "arbitrary-orientations",
        "notes": notes,
        "site": {"gravity_m_s2": gravity},
        **more,
        "sensors": sensors,
        "table": table,
    }


def columns(sensors: list[Document], values: Columns) -> dict[str, list[object]]:
    """The table's columns of sensors from values (rows, sensors)."""
    return {entry["name"]: values[:, k].tolist() for k, entry in enumerate(sensors)}
