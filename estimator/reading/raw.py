"""The rows of a raw log, screened: what they read, when, and at what rate they were taken."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from estimator.message import joined
from estimator.reading.bounds import WITHIN
from estimator.reading.columns import Columns
from estimator.reading.fields import Fields
from estimator.reading.keys import DIRECTIONS
from estimator.reading.problems import shown
from estimator.screening import KINDS, OFF, Screen, Screening, declined_by
from estimator.screening.clock import MOST_POSITIONS, SHORTEST_REST, no_rate, rate_of, usual_step
from estimator.session import CALIBRATIONS, IN_SERVICE, RATE_TABLE, ROTATION_ALIGNMENT, Array, Sensor

LABELS = ("run", "beta_deg", "position", *DIRECTIONS)
"""Columns that say where the block stood."""
HELD = 20
"""Rows under one label from which they are samples: nobody sets a stand to one angle twenty times in a row."""
EVERY_ROW = (ROTATION_ALIGNMENT, RATE_TABLE)
"""Programmes in which a row is the mean since the one before, so that none can be left out."""


@dataclass(frozen=True, eq=False)
class Raw:
    """The times of a table's rows; and its samples, if it is a raw log. R rows, m sensors."""

    readings: Array | None
    """(R, m), reading units, NaN where left out; None of averaged positions."""
    time: Array | None
    """(R,) s."""
    rate: float | None
    """Hz; None of averaged positions."""
    screening: Screening
    unscreened: tuple[str, ...]
    """Kinds that the file declines."""


def read_raw(
    document: Fields,
    columns: Columns,
    programme: str,
    sensors: tuple[Sensor, ...],
    *,
    part: bool,
    screen: Screen | None,
) -> Raw:
    """Records what cannot be corrected. A ``part`` of a longer log without its ``screen`` is taken as it stands."""
    sensors = tuple(sensor for sensor in sensors if sensor.name)
    rate = document.optional_number("sample_rate_hz", WITHIN["sample_rate_hz"])
    declined = _declined(document)
    time = columns.numbers("time_s", WITHIN["time_s"]) if columns.has("time_s") else None
    is_alone = screen is None
    if screen is None:
        screen = Screen(sensors, frozenset(KINDS if part else declined), rate, in_service=programme == IN_SERVICE)
    fault = columns.problems.add
    if is_alone and not part and rate is None and programme in CALIBRATIONS:
        screen.rate = rate = _found_rate(columns, time, sensors, screen)
    if time is not None and np.isfinite(time).all() and not (part and is_alone):
        time = screen.times(time, _moved(columns), fault)
    if rate is None:
        return Raw(None, time, None, screen.findings, declined)
    readings = _samples(columns, sensors, holes=screen.looks_for("missing") or part)
    if not (part and is_alone):
        readings = screen.readings(readings)
    if is_alone and not part:
        screen.check(fault)
        time = None if time is not None and screen.clock_stands else time
    if programme in EVERY_ROW and not part:
        for finding in screen.findings:
            if finding.action == "left-out" and finding.sensors:
                fault(
                    finding.sensors[0],
                    "{finding} {programme} needs every row.",
                    programme=programme,
                    finding=finding.message,
                )
    return Raw(readings, time, rate, screen.findings if is_alone else (), declined)


def _declined(document: Fields) -> tuple[str, ...]:
    """The kinds that the file does not want to be screened for."""
    stated = document.values.get("screening")
    declined = declined_by(stated)
    if declined is None:
        advice = 'is {stated}; give "{off}", or a list of what not to look for: {kinds}'
        document.add("screening", advice, stated=shown(stated), off=OFF, kinds=joined(", ", KINDS))
    return declined or ()


def _found_rate(columns: Columns, time: Array | None, sensors: tuple[Sensor, ...], screen: Screen) -> float | None:
    """The rate of rows that are samples, Hz; None of positions."""
    means = [f"{sensor.name}_se" for sensor in sensors] + ["tilt_se_deg"]
    if not screen.looks_for("rate") or any(columns.has(name) for name in means):
        return None
    is_labelled = any(columns.has(name) for name in LABELS)
    held = columns.rows / (1 + int(_moved(columns).sum()))
    if is_labelled and (held < HELD or (time is not None and usual_step(time) >= SHORTEST_REST)):
        return None
    rate = None if time is None else rate_of(time)
    if rate is None and (is_labelled or columns.rows > MOST_POSITIONS):
        columns.problems.add("sample_rate_hz", no_rate(columns.rows, time, held if is_labelled else None))
    if rate is not None:
        screen.note_rate(rate, columns.rows)
    return rate


def _samples(columns: Columns, sensors: tuple[Sensor, ...], *, holes: bool) -> Array:
    """(R, m) samples as they stand."""
    names, within = [sensor.name for sensor in sensors], WITHIN["<sensor>"]
    read = columns.samples if holes else columns.numbers
    for name in (name for name in names if not columns.has(name)):
        columns.report_missing(name)
    none = np.full(columns.rows, np.nan)
    return np.array([read(name, within) if columns.has(name) else none for name in names]).reshape(-1, columns.rows).T


def _moved(columns: Columns) -> Array:
    """(R,) whether a row stands under another label than the one before."""
    moved = np.zeros(columns.rows, dtype=bool)
    for cells in (columns.values[name] for name in LABELS if columns.has(name)):
        is_array = isinstance(cells, np.ndarray)
        changes = cells[1:] != cells[:-1] if is_array else [a != b for a, b in pairwise(cells)]
        if len(cells) == len(moved):
            moved[1:] |= np.asarray(changes, dtype=bool)
    return moved
