"""What moved since the history: the parameters of earlier sessions as one reference with covariance.

In arbitrary orientations the applied vectors are estimated, so a common turn of all axes cannot be observed: earlier
axes are turned onto those of now first, and only what is orthogonal to a common turn is compared.
"""

from collections.abc import Sequence

import numpy as np

from estimator.arrays import nearest_turn, tangents
from estimator.diagnosis.baseline import Baseline
from estimator.diagnosis.evidence import Between, parameter_covariance
from estimator.diagnosis.turning import comparable_directions, free_to_turn
from estimator.session import Array

WITHOUT = 1e-13
"""Variance over the largest (each parameter in its own sigma) below which a direction has none."""


def deviation_of(earlier: Baseline, now: Baseline) -> tuple[Array, Array]:
    """Parameters of an earlier session seen from now: dimensionless deviation (P,) and covariance (P, P)."""
    p, q, norm = now.parameters, earlier.parameters, now.setting.norm
    m = len(norm)
    turned = nearest_turn(q.axis, p.axis) if free_to_turn(now).any() else np.eye(3)
    frame, old, axis = tangents(p.axis), turned @ tangents(q.axis), q.axis @ turned.T
    step = np.empty((m, 5))
    step[:, 0] = np.log(q.scale / p.scale)
    step[:, 1] = (q.bias - p.bias) / norm
    step[:, 2] = (q.quadratic - p.quadratic) * norm
    step[:, 3:] = (np.swapaxes(frame, -1, -2) @ (axis - p.axis)[..., None])[..., 0]
    mapping = np.zeros((m, 5, 5))
    mapping[:, [0, 1, 2], [0, 1, 2]] = 1.0
    mapping[:, 3:, 3:] = np.swapaxes(frame, -1, -2) @ old
    full = np.zeros((5 * m, 5 * m))
    for i in range(m):
        full[5 * i : 5 * i + 5, 5 * i : 5 * i + 5] = mapping[i]
    return step.reshape(-1), full @ parameter_covariance(earlier) @ full.T


def reference(now: Baseline, history: Sequence[Baseline], keep: Array) -> tuple[Array, Array] | None:
    """Information-weighted mean of the history's parameters, as deviation from now, with covariance.

    ``keep`` (P, q) as in `comparable_directions`; the answer is in its coordinates.
    """
    matching = [h for h in history if h.setting.kinds == now.setting.kinds]
    if not matching:
        return None
    information, weighted = np.zeros((keep.shape[1],) * 2), np.zeros(keep.shape[1])
    for earlier in matching:
        step, covariance = deviation_of(earlier, now)
        root = inverse_root(keep.T @ covariance @ keep)
        information += root.T @ root
        weighted += root.T @ (root @ (keep.T @ step))
    covariance = (root := inverse_root(information)).T @ root
    return covariance @ weighted, covariance


def inverse_root(matrix: Array) -> Array:
    """W, symmetric up to scale, with W'W the pseudo-inverse of a covariance."""
    scale = np.sqrt(np.diagonal(matrix))
    values, vectors = np.linalg.eigh(matrix / scale[:, None] / scale)
    kept = values > WITHOUT * values[-1]
    inverse = np.where(kept, 1 / np.sqrt(np.where(kept, values, 1.0)), 0.0)
    return np.asarray((vectors * inverse) @ vectors.T / scale)


def between_sessions(now: Baseline, history: Sequence[Baseline]) -> Between | None:
    """The whitened move of all parameters since the history; None without a usable history."""
    keep = comparable_directions(now)
    found = reference(now, history, keep)
    if found is None:
        return None
    step, covariance = found
    response = keep @ inverse_root(covariance + keep.T @ parameter_covariance(now) @ keep) @ keep.T
    return Between(response @ (keep @ -step), response)
