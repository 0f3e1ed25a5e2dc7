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
    """Axes that no block of this unit can have."""

    sensors: tuple[int, ...]
    """The sensors whose axis is off by itself; none where all turned together."""
    angle: float
    """The largest, rad."""
    step: float | None = None
    """Change of the one sensor's zero from the direct to the flipped run, m/s² (rad/s), where that may be the true
    fault: on a stand it has the same effect on the readings.
    """


def implausible_axes(baseline: Baseline, expected: Array) -> ImplausibleAxes | None:
    """The axes too far from the ``expected`` ones (m, 3), unit vectors; None where there are none.

    In arbitrary orientations a turn of the whole block is not seen and means nothing.
    """
    axes = baseline.parameters.axis
    turn = nearest_turn(expected, axes)
    angle = np.arccos(np.clip((axes * (expected @ turn.T)).sum(axis=-1), -1.0, 1.0))
    if angle.max() > BEYOND:
        sensors = tuple(np.flatnonzero(angle > BEYOND).tolist())
        step = step_between_runs(baseline, sensors[0], expected) if len(sensors) == 1 else None
        return ImplausibleAxes(sensors, float(angle.max()), step)
    whole = float(np.arccos(np.clip((np.trace(turn) - 1) / 2, -1.0, 1.0)))
    return ImplausibleAxes((), whole) if whole > BEYOND and not baseline.gauge_free.any() else None


def step_between_runs(baseline: Baseline, i: int, expected: Array) -> float | None:
    """The change of sensor i's zero from the direct to the flipped run that alone puts it off its ``expected`` axis, of
    (m, 3) unit vectors: m/s² (rad/s); None where no such change does.

    Its component along the head's axis, which the flip turns over and β leaves alone, is all that may be off then.
    """
    session, p = baseline.session, baseline.parameters
    if session.flipped is None or session.flipped.all() or not session.flipped.any():
        return None
    head = session.mounting[:, 1]
    off = p.scale[i] / session.sensors[i].nominal_scale * p.axis[i] - expected[i]
    along = float(off @ head)
    if np.linalg.norm(off - along * head) > np.sin(BEYOND):
        return None
    return float(-2 * along * (baseline.setting.n[~session.flipped, i] @ head).mean())
