"""What moved since the history: the parameters of earlier sessions as one reference with covariance.

In arbitrary orientations the applied vectors are estimated, so a common turn of all axes cannot be observed: earlier
axes are turned onto those of now first, and only what is orthogonal to a common turn is compared.
"""

from collections.abc import Sequence

import numpy as np

from estimator.arrays import nearest_turn, tangents
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.gauge import comparable_directions, free_to_turn
from estimator.diagnosis.residuals.whitened import Between, Evidence, Past, parameter_covariance
from estimator.session import Array

WITHOUT = 1e-13
"""Variance over the largest (each parameter in its own sigma) below which a direction has none."""


def deviation_of(earlier: Baseline, now: Baseline) -> tuple[Array, Array]:
    """Parameters of an earlier session seen from now: dimensionless deviation (P,) and how they map there (P, P)."""
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
    return step.reshape(-1), full


def inverse_root(matrix: Array) -> Array:
    """W, symmetric up to scale, with W'W the pseudo-inverse of a covariance."""
    scale = np.sqrt(np.diagonal(matrix))
    values, vectors = np.linalg.eigh(matrix / scale[:, None] / scale)
    kept = values > WITHOUT * values[-1]
    inverse = np.where(kept, 1 / np.sqrt(np.where(kept, values, 1.0)), 0.0)
    return np.asarray((vectors * inverse) @ vectors.T / scale)


def between_sessions(now: Baseline, history: Sequence[Baseline]) -> Between | None:
    """The whitened move of all parameters since the history; None without a usable history.

    The reference is the information-weighted mean of the history's parameters.
    """
    keep, matching = comparable_directions(now), [h for h in history if h.setting.kinds == now.setting.kinds]
    if not matching:
        return None
    steps, maps = zip(*(deviation_of(earlier, now) for earlier in matching), strict=True)
    known = [keep.T @ turn @ parameter_covariance(h) @ turn.T @ keep for h, turn in zip(matching, maps, strict=True)]
    information = [(root := inverse_root(covariance)).T @ root for covariance in known]
    covariance = (root := inverse_root(np.sum(information, axis=0))).T @ root
    weights = [keep @ covariance @ own @ keep.T for own in information]
    response = keep @ inverse_root(covariance + keep.T @ parameter_covariance(now) @ keep) @ keep.T
    step = np.sum([weight @ step for weight, step in zip(weights, steps, strict=True)], axis=0)
    past = [Past(Evidence.of(h), w @ turn) for h, w, turn in zip(matching, weights, maps, strict=True)]
    return Between(response @ -step, response, tuple(past))
