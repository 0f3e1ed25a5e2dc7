"""The common turn of all axes, which arbitrary orientations cannot observe: every applied vector may turn with it."""

import numpy as np

from estimator.arrays import tangents
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.parameters import SensorParameters
from estimator.session import ACCELEROMETER, Array


def free_to_turn(baseline: Baseline) -> Array:
    """(m,) bool: sensors whose axes may turn together unseen, because no row's applied vector is known."""
    unseen = baseline.row_sigma.size > 0 and bool(np.isinf(baseline.row_sigma).all())
    return np.array([unseen and kind == ACCELEROMETER for kind in baseline.setting.kinds])


def comparable_directions(now: Baseline) -> Array:
    """(P, q) orthonormal: every direction of the parameters but a common turn of what is free to turn."""
    free, parameters = free_to_turn(now), now.parameters
    if not free.any():
        return np.eye(5 * len(free))
    turn = np.zeros((len(free), 5, 3))
    turn[:, 3:] = turned_axes(parameters) * free[:, None, None]
    left, _, _ = np.linalg.svd(turn.reshape(-1, 3))
    return np.asarray(left[:, 3:])


def turned_axes(parameters: SensorParameters) -> Array:
    """(m, 2, 3) tangent components of every axis' answer k×e to a small rotation vector k."""
    cross = np.stack([np.cross(k, parameters.axis) for k in np.eye(3)], axis=-1)
    return np.asarray(np.swapaxes(tangents(parameters.axis), -1, -2) @ cross)
