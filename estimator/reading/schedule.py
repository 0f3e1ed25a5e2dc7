"""Whether the rows of a well-formed session can support its programme."""

import numpy as np

from estimator.reading.problems import Problems
from estimator.reading.table import Table
from estimator.session import ARBITRARY_ORIENTATIONS, TWO_AXIS_STAND

FEWEST_POSITIONS = 2


def check_schedule(programme: str, table: Table, *, raw: bool, problems: Problems) -> None:
    """Record schedules that cannot be calibrated from whatever is read; what is hard to observe is a result instead."""
    if programme == TWO_AXIS_STAND:
        _check_beta(table, problems)
    if programme in (TWO_AXIS_STAND, ARBITRARY_ORIENTATIONS):
        _check_positions(table, raw, problems)


def _check_beta(table: Table, problems: Problems) -> None:
    if table.beta is None or np.isnan(table.beta).any():
        return
    if np.unique(np.exp(1j * table.beta).round(9)).size < FEWEST_POSITIONS:
        problems.add_to_schedule("beta_deg", "all rows stand at a single position; turn the head and read at several β")


def _check_positions(table: Table, raw: bool, problems: Problems) -> None:
    if table.position is not None:
        labels = np.unique(table.position[table.position >= 0])
        if labels.size < FEWEST_POSITIONS:
            found = "a single position" if labels.size else "no position"
            problems.add_to_schedule("position", f"the rows belong to {found}; a calibration needs several")
    elif len(table.readings) < FEWEST_POSITIONS:
        needs = "the samples of a whole log" if raw else "several orientations"
        problems.add_to_schedule("table", f"has a single row, a single position; a calibration needs {needs}")
