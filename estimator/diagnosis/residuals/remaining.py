"""What effects leave of a session's readings: residuals and degrees of freedom."""

import numpy as np

from estimator.diagnosis.residuals.whitened import INVISIBLE, WhitenedResiduals
from estimator.least_squares import orthonormal
from estimator.session import Array

NEW_DIRECTION = 1e-6
"""Share of a trace that must lie outside the others' span to count as a direction of its own: rounding lies below."""


def remaining_of_sensors(residuals: WhitenedResiduals, named: Array | None) -> tuple[Array, Array]:
    """(m,) energy, dimensionless, and (m,) degrees of freedom of what effects (R, m, q) leave of each sensor."""
    z, freedom = left_by(residuals, named)
    of_sensor = residuals.sensor_of_row[: residuals.rows] == np.arange(len(residuals.baseline.unstated))[:, None]
    return of_sensor @ z**2, of_sensor @ freedom


def left_by(residuals: WhitenedResiduals, named: Array | None) -> tuple[Array, Array]:
    """(N,) standard errors, the session's rows beside effects (R, m, q), any unit, and (N,) their degrees of freedom;
    beside nothing where None."""
    z, freedom = residuals.z[: residuals.rows], residuals.row_freedom
    if named is None:
        return z, freedom
    trace, raw = residuals.trace(named)[: residuals.rows], np.linalg.norm(residuals.whitened(named), axis=0)
    basis = orthonormal(trace[:, np.linalg.norm(trace, axis=0) > INVISIBLE * raw], NEW_DIRECTION)
    return z - basis @ (basis.T @ z), freedom - (basis**2).sum(axis=1)
