"""The columns of a session file → the arrays of a session, in SI."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimator.message import joined
from estimator.reading.bounds import WITHIN
from estimator.reading.columns import Columns
from estimator.reading.fields import Fields
from estimator.reading.interval import Interval
from estimator.reading.keys import DIRECTIONS
from estimator.reading.raw import read_raw
from estimator.reading.shape import check_unknown, read_columns
from estimator.screening import Screen, Screening
from estimator.session import RATE_TABLE, ROTATION_ALIGNMENT, THERMAL, TWO_AXIS_STAND, Array, Sensor

RUNS = ("direct", "flipped")
"""Values of the column ``run``."""
OF_MEANS = "standard errors belong to averaged readings; remove them from a raw log"
"""Message about standard errors in a raw log."""
SHORTEST_DIRECTION = 1e-3
"""Length, in whatever unit the components are written: shorter is a zero that was rounded."""


@dataclass(frozen=True)
class Table:
    """The table's arrays, as in `CalibrationSession`. R rows, m sensors."""

    readings: Array
    standard_errors: Array
    flipped: NDArray[np.bool_] | None
    beta: Array | None
    time: Array | None
    temperature: Array | None
    vibration: Array | None
    tilt_error: Array | None
    turn_angle: Array | None
    turn_rate: Array | None
    position: NDArray[np.int64] | None
    directions: Array | None
    direction_sigma: float | None
    sample_rate: float | None
    screening: Screening
    unscreened: tuple[str, ...]


def read_table(
    document: Fields, programme: str, sensors: tuple[Sensor, ...], *, part: bool = False, screen: Screen | None = None
) -> Table | None:
    """Every array of the table; None when there is no usable one. ``part`` and ``screen`` as in `read_session`."""
    columns = read_columns(document)
    if columns is None:
        return None
    names = [sensor.name for sensor in sensors if sensor.name]
    check_unknown(columns, names)
    on_stand = programme == TWO_AXIS_STAND
    directions = _directions(columns)
    raw = read_raw(document, columns, programme, sensors, part=part, screen=screen)
    return Table(
        readings=_readings(columns, names) if raw.readings is None else raw.readings,
        standard_errors=_standard_errors(columns, names, raw=document.has("sample_rate_hz")),
        flipped=_flipped(columns) if on_stand else None,
        beta=np.radians(_required(columns, "beta_deg")) if on_stand else None,
        time=raw.time,
        temperature=(_required if programme == THERMAL else _optional)(columns, "temperature_c"),
        vibration=_vibration(columns, len(names)),
        tilt_error=_tilt_error(columns, raw=document.has("sample_rate_hz")),
        turn_angle=_turning(columns, "turn_angle_deg", needed=programme == ROTATION_ALIGNMENT),
        turn_rate=_turning(columns, "turn_rate_deg_s", needed=programme == RATE_TABLE),
        position=columns.labels("position") if columns.has("position") else None,
        directions=directions,
        direction_sigma=_direction_sigma(document, columns),
        sample_rate=raw.rate,
        screening=raw.screening,
        unscreened=raw.unscreened,
    )


def _readings(columns: Columns, names: list[str]) -> Array:
    """(R, m), of averaged positions."""
    return _stack([_required(columns, name, WITHIN["<sensor>"]) for name in names], columns.rows)


def _required(columns: Columns, name: str, within: Interval | None = None) -> Array:
    if columns.has(name):
        return columns.numbers(name, within or WITHIN[name])
    columns.report_missing(name)
    return np.full(columns.rows, np.nan)


def _optional(columns: Columns, name: str) -> Array | None:
    return columns.numbers(name, WITHIN[name]) if columns.has(name) else None


def _vibration(columns: Columns, m: int) -> Array | None:
    """(R, m) (m/s²)² of every sensor: the square of what is stated for all."""
    rms = _optional(columns, "vibration_m_s2")
    return None if rms is None else np.repeat(rms[:, None] ** 2, m, axis=1)


def _tilt_error(columns: Columns, *, raw: bool) -> Array | None:
    """(R,) rad; 0 where none is stated."""
    if not columns.has("tilt_se_deg"):
        return None
    if raw:
        columns.problems.add("tilt_se_deg", OF_MEANS)
    return np.nan_to_num(np.radians(columns.numbers("tilt_se_deg", WITHIN["tilt_se_deg"], holes=True)))


def _turning(columns: Columns, name: str, *, needed: bool) -> Array | None:
    """(R,) rad or rad/s, of a turntable."""
    read = _required if needed else _optional
    degrees = read(columns, name)
    return None if degrees is None else np.radians(degrees)


def _stack(arrays: list[Array], rows: int) -> Array:
    """(R, m)."""
    return np.column_stack(arrays) if arrays else np.empty((rows, 0))


def _standard_errors(columns: Columns, names: list[str], *, raw: bool) -> Array:
    """(R, m), NaN where none is stated."""
    stated = [f"{name}_se" for name in names if columns.has(f"{name}_se")]
    if raw and stated:
        columns.problems.add(stated[0], OF_MEANS)
    empty = np.full(columns.rows, np.nan)
    return _stack(
        [
            columns.numbers(f"{name}_se", WITHIN["<sensor>_se"], holes=True) if f"{name}_se" in stated else empty
            for name in names
        ],
        columns.rows,
    )


def _flipped(columns: Columns) -> NDArray[np.bool_]:
    if not columns.has("run"):
        columns.report_missing("run")
        return np.zeros(columns.rows, dtype=bool)
    return columns.words("run", RUNS) == RUNS.index("flipped")


def _directions(columns: Columns) -> Array | None:
    """(R, 3) unit vectors; NaN rows where a direction is unknown."""
    given = [name for name in DIRECTIONS if columns.has(name)]
    if not given:
        return None
    for name in DIRECTIONS:
        if name not in given:
            columns.report_missing(name)
    stated = [columns.numbers(name, WITHIN["direction_x…z"], holes=True) for name in given]
    if len(given) < 3 or any(np.isnan(component).all() for component in stated):
        return None
    vectors = np.column_stack(stated)
    length = np.linalg.norm(vectors, axis=1)
    torn = np.isnan(vectors).any(axis=1) & ~np.isnan(vectors).all(axis=1)
    columns.problems.add_rows(
        DIRECTIONS[0], np.flatnonzero(torn).tolist(), lambda _: "give all three components of a direction, or none"
    )
    columns.problems.add_rows(
        DIRECTIONS[0],
        np.flatnonzero(length < SHORTEST_DIRECTION).tolist(),
        lambda _: "the direction has length zero; give a unit vector, or leave it empty where unknown",
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        unit: Array = vectors / length[:, None]
    return unit


def _direction_sigma(document: Fields, columns: Columns) -> float | None:
    """rad."""
    key = "direction_sigma_deg"
    if any(columns.has(name) for name in DIRECTIONS):
        return math.radians(document.number(key, WITHIN[key], "give the uncertainty of the stated directions"))
    if document.has(key):
        document.add(
            key,
            "is given without directions; add the columns {directions} or remove it",
            directions=joined(", ", DIRECTIONS),
        )
    return None
