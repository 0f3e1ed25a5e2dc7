"""Gauge freedom: in arbitrary orientations all axes may turn together, and every applied vector with them, unseen."""

import numpy as np

from estimator.arrays import crossed
from estimator.parameters import SensorParameters
from estimator.session import Array


def observable_directions(free: Array, parameters: SensorParameters) -> Array:
    """(P, q) orthonormal, dimensionless: every direction of the P = 5 m parameters but a common turn of free axes.

    ``free`` (m,) bool, `Baseline.gauge_free`.
    """
    if not free.any():
        return np.eye(5 * len(free))
    turn = turn_response(parameters) * np.repeat(free, 5)[:, None]
    directions, _, _ = np.linalg.svd(turn)
    return np.asarray(directions[:, 3:])


def turn_response(parameters: SensorParameters) -> Array:
    """(P, 3) per rad: change of all P = 5 m parameters with a small rotation of the block; leading axes are free."""
    response = np.zeros((*parameters.scale.shape, 5, 3))
    response[..., 3:, :] = axis_response(parameters)
    return response.reshape(*parameters.scale.shape[:-1], -1, 3)


def axis_response(parameters: SensorParameters) -> Array:
    """(m, 2, 3) rad per rad: tangent components of every axis' response k×e to a small rotation vector k."""
    return np.asarray(np.swapaxes(parameters.axis_tangents, -1, -2) @ crossed(parameters.axis))
