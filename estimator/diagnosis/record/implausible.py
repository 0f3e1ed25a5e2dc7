"""Axes that no sensor can have: the record is wrong in a way that no correction of the catalogue repairs.

Then everything within the session is made of the wrong record too, and no cause is named from it.
"""

from dataclasses import dataclass

import numpy as np

from estimator.arrays import nearest_turn
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.session import Array

BEYOND = np.radians(15.0)
"""rad; no axis is mounted, no block sits, as far from where it should; exchanged columns, runs or angles of a record
turn them further."""


@dataclass(frozen=True)
class ImplausibleAxes:
    """Where axes came out that no block of this unit can have."""

    sensors: tuple[int, ...]
    """Those whose axis is off by itself; none where all turned together."""
    angle: float
    """The largest, rad."""


def implausible_axes(baseline: Baseline, expected: Array) -> ImplausibleAxes | None:
    """The axes too far from the ``expected`` ones (m, 3), unit vectors; None where there are none.

    In arbitrary orientations a turn of the whole block is not seen and means nothing.
    """
    axes = baseline.parameters.axis
    turn = nearest_turn(expected, axes)
    angle = np.arccos(np.clip((axes * (expected @ turn.T)).sum(axis=-1), -1.0, 1.0))
    if angle.max() > BEYOND:
        return ImplausibleAxes(tuple(np.flatnonzero(angle > BEYOND).tolist()), float(angle.max()))
    whole = float(np.arccos(np.clip((np.trace(turn) - 1) / 2, -1.0, 1.0)))
    return ImplausibleAxes((), whole) if whole > BEYOND and not baseline.gauge_free.any() else None
