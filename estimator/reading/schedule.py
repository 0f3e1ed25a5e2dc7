"""Whether the rows of a well-formed session can support its programme."""

import numpy as np

from estimator.reading.problems import Problems
from estimator.reading.table import Table
from estimator.session import (
    ACCELEROMETER,
    ARBITRARY_ORIENTATIONS,
    GYROSCOPE,
    RATE_TABLE,
    ROTATION_ALIGNMENT,
    THERMAL,
    TWO_AXIS_STAND,
    CalibrationSession,
)

Rows = Table | CalibrationSession
"""The table of a file, or the positions that were averaged of a log."""

FEWEST_POSITIONS = 2
"""A single one shows nothing about any programme; whether more are enough is a result."""

NEEDED_KINDS = {ROTATION_ALIGNMENT: (ACCELEROMETER, GYROSCOPE), RATE_TABLE: (GYROSCOPE,)}
"""Sensors that a programme on a turntable works with."""


def check_schedule(programme: str, table: Rows, kinds: set[str], *, raw: bool, problems: Problems) -> None:
    """Record schedules that cannot be calibrated from whatever is read; what is hard to observe is a result instead."""
    if programme == TWO_AXIS_STAND:
        _check_beta(table, problems)
    if programme in (TWO_AXIS_STAND, ARBITRARY_ORIENTATIONS, THERMAL):
        _check_positions(table, raw, problems)
    if programme in NEEDED_KINDS:
        _check_turning(programme, table, kinds, raw, problems)


def _check_turning(programme: str, table: Rows, kinds: set[str], raw: bool, problems: Problems) -> None:
    """A time series on a turntable: it needs times, and the sensors that the programme works with."""
    for kind in NEEDED_KINDS[programme]:
        if kind not in kinds:
            problems.add("sensors", "none of kind {kind}; {programme} needs them", kind=kind, programme=programme)
    if table.time is None and not raw:
        problems.add(
            "time_s",
            "the column is missing; {programme} needs it, or sample_rate_hz for a raw log",
            programme=programme,
        )


def _check_beta(table: Rows, problems: Problems) -> None:
    if table.beta is None or np.isnan(table.beta).any():
        return
    if np.unique(np.exp(1j * table.beta).round(9)).size < FEWEST_POSITIONS:
        problems.add_to_schedule(
            "beta_deg", "all rows are at a single position; turn the head and measure at several β"
        )


def _check_positions(table: Rows, raw: bool, problems: Problems) -> None:
    if table.position is not None:
        labels = np.unique(table.position[table.position >= 0])
        if labels.size < FEWEST_POSITIONS:
            problem = "a single position" if labels.size else "no position"
            problems.add_to_schedule(
                "position", "the rows belong to {problem}; a calibration needs several", problem=problem
            )
    elif len(table.readings) < FEWEST_POSITIONS:
        needs = "the samples of a whole log" if raw else "several orientations"
        problems.add_to_schedule(
            "table", "has a single row, a single position; a calibration needs {needs}", needs=needs
        )
