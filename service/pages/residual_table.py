"""The residuals as a table: what the charts show, for those who read numbers."""

from dataclasses import dataclass

import numpy as np

from estimator.results import Calibration
from service.measures import deviation_measure, number

RUNS = ("direct", "flipped")
"""By whether the head is turned over."""


@dataclass(frozen=True)
class ResidualRow:
    """One row of the session."""

    number: int
    run: str
    beta: str
    values: tuple[str, ...]


@dataclass(frozen=True)
class ResidualTable:
    """Residuals of all sensors, row by row."""

    heads: tuple[str, ...]
    beta: bool
    """Whether the session has angles and runs of a stand."""
    rows: tuple[ResidualRow, ...]


def residual_table(calibration: Calibration) -> ResidualTable:
    """Residuals with the measure in each column's head."""
    found = calibration.residuals
    largest = np.nanmax(np.abs(found.value), axis=0, initial=0.0)
    measures = [deviation_measure(s.kind, "bias", x) for s, x in zip(calibration.sensors, largest, strict=True)]
    shown = found.value * [measure.factor for measure in measures]
    beta, flipped = found.beta, found.flipped
    return ResidualTable(
        heads=tuple(f"{s.name}, {u.label}" for s, u in zip(calibration.sensors, measures, strict=True)),
        beta=beta is not None,
        rows=tuple(
            ResidualRow(
                number=row + 1,
                run="" if flipped is None else RUNS[int(flipped[row])],
                beta="" if beta is None else number(float(np.degrees(beta[row])), 1),
                values=tuple(number(float(value)) for value in shown[row]),
            )
            for row in range(len(shown))
        ),
    )
