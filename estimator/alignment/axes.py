"""Blocks of any number of sensors reduced to three axes, by weighted least squares with their covariance.

A block of m > 3 sensors reads y = H·w + noise, H (m, 3) the nominal axes, noise of covariance R. The block's rate or
specific force is ŵ = (HᵀR⁻¹H)⁻¹HᵀR⁻¹y with covariance (HᵀR⁻¹H)⁻¹. What the m − 3 surplus readings say of single
sensors is not part of an alignment.
"""

from dataclasses import dataclass

import numpy as np

from estimator.errors import Problem, ScheduleError
from estimator.session import ACCELEROMETER, Array, CalibrationSession

LEAST_SHARE = 1e-4
"""Part of the largest variance that a sensor is given at least: no channel counts for ten thousand others."""
TINY = 1e-12
"""m/s² or rad/s; keeps the covariance of readings without noise invertible."""


@dataclass(frozen=True, eq=False)
class Triad:
    """Readings of one kind reduced to block axes. R rows."""

    values: Array
    """(R, 3) mean over each row, m/s² or rad/s."""
    row_covariance: Array | None
    """(3, 3) covariance of a row's white noise as the file states it; None when it does not."""
    sensors: int
    """Number of sensors that were reduced."""


def reduction(axes: Array, covariance: Array) -> tuple[Array, Array]:
    """(3, m) dimensionless matrix that turns inputs into block axes, and the covariance (3, 3) of the outcome.

    Parameters
    ----------
    axes : (m, 3) unit vectors.
    covariance : (m, m) of the inputs, positive definite, (m/s²)² or (rad/s)², and so is the outcome's.
    """
    weighted = np.linalg.solve(covariance, axes)
    outcome = np.linalg.inv(axes.T @ weighted)
    return outcome @ weighted.T, outcome


def triad(session: CalibrationSession, kind: str, interval: float, measured: Array | None = None) -> Triad:
    """The sensors of a kind as three axes; ``interval`` is the time of a row, s.

    Sensors are weighted by their stated standard errors, else by the scatter of their readings from row to row, of
    those rows that were ``measured`` (R,) bool, all unless given.
    """
    chosen = of_kind(session, kind)
    require_alive(session, chosen)
    inputs, per_input = inputs_of(session, kind)
    stated = session.standard_errors[:, chosen] / per_input
    known = bool(np.isfinite(stated).all())
    variance = np.mean(stated**2, axis=0) if known else scatter(inputs if measured is None else inputs[measured])
    axes = np.stack([session.sensors[i].nominal_axis for i in chosen])
    matrix, covariance = reduction(axes, np.diag(variance))
    return Triad(inputs @ matrix.T, covariance if known else None, len(chosen))


def of_kind(session: CalibrationSession, kind: str) -> list[int]:
    """Places of the sensors of a kind among all."""
    return [i for i, sensor in enumerate(session.sensors) if sensor.kind == kind]


def inputs_of(session: CalibrationSession, kind: str) -> tuple[Array, Array]:
    """(R, m) inputs of the sensors of a kind, m/s² or rad/s, and (m,) reading units per unit of input."""
    chosen = of_kind(session, kind)
    scale = np.array([session.sensors[i].nominal_scale for i in chosen])
    offset = np.array([session.sensors[i].nominal_offset or 0.0 for i in chosen])
    pulses = kind != ACCELEROMETER and session.count_time is not None
    per_input = scale * (session.count_time if pulses and session.count_time else 1.0)
    return (session.readings[:, chosen] - offset) / per_input, per_input


def scatter(values: Array) -> Array:
    """(m,) variance of white noise from third differences of values (R, m), m/s² or rad/s, free of smooth motion.

    Never zero, and none so small beside the others that one channel would count for all.
    """
    steps = np.diff(values, n=3, axis=0)
    quiet = np.median(np.abs(steps), axis=0) / 0.6745 if len(steps) else np.zeros(values.shape[1])
    variance = quiet**2 / 20
    return np.maximum(variance, LEAST_SHARE * variance.max(initial=0.0)) + TINY**2


def require_alive(session: CalibrationSession, chosen: list[int]) -> None:
    """ScheduleError for sensors that read the same in every row."""
    stuck = [session.sensors[i].name for i in chosen if np.ptp(session.readings[:, i]) == 0]
    if stuck:
        raise ScheduleError([Problem(name, "has the same reading in every row; check the channel") for name in stuck])
