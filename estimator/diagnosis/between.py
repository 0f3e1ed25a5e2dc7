"""What moved since the history: the parameters of earlier sessions as one reference with covariance."""

from collections.abc import Sequence

import numpy as np

from estimator.arrays import tangents
from estimator.diagnosis.baseline import Baseline
from estimator.diagnosis.evidence import Between, parameter_covariance
from estimator.session import Array


def deviation_of(earlier: Baseline, now: Baseline) -> tuple[Array, Array]:
    """Parameters of an earlier session seen from now: dimensionless deviation (P,) and covariance (P, P)."""
    p, q, norm = now.parameters, earlier.parameters, now.setting.norm
    m = len(norm)
    frame, old = tangents(p.axis), tangents(q.axis)
    turn = np.swapaxes(frame, -1, -2) @ old
    step = np.empty((m, 5))
    step[:, 0] = np.log(q.scale / p.scale)
    step[:, 1] = (q.bias - p.bias) / norm
    step[:, 2] = (q.quadratic - p.quadratic) * norm
    step[:, 3:] = (np.swapaxes(frame, -1, -2) @ (q.axis - p.axis)[..., None])[..., 0]
    mapping = np.zeros((m, 5, 5))
    mapping[:, [0, 1, 2], [0, 1, 2]] = 1.0
    mapping[:, 3:, 3:] = turn
    full = np.zeros((5 * m, 5 * m))
    for i in range(m):
        full[5 * i : 5 * i + 5, 5 * i : 5 * i + 5] = mapping[i]
    return step.reshape(-1), full @ parameter_covariance(earlier) @ full.T


def reference(now: Baseline, history: Sequence[Baseline]) -> tuple[Array, Array] | None:
    """Information-weighted mean of the history's parameters, as deviation from now, with covariance."""
    matching = [h for h in history if h.setting.kinds == now.setting.kinds]
    if not matching:
        return None
    P = 5 * len(now.setting.norm)
    information, weighted = np.zeros((P, P)), np.zeros(P)
    for earlier in matching:
        step, covariance = deviation_of(earlier, now)
        root = inverse_root(covariance)
        information += root.T @ root
        weighted += root.T @ (root @ step)
    covariance = (root := inverse_root(information)).T @ root
    return covariance @ weighted, covariance


def inverse_root(matrix: Array) -> Array:
    """W with W'W the pseudo-inverse of a covariance (a gauge leaves directions without variance)."""
    scale = np.sqrt(np.diagonal(matrix))
    values, vectors = np.linalg.eigh(matrix / scale[:, None] / scale)
    kept = values > 1e-10
    inverse = np.where(kept, 1 / np.sqrt(np.where(kept, values, 1.0)), 0.0)
    return np.asarray((vectors * inverse) @ vectors.T / scale)


def between_sessions(now: Baseline, history: Sequence[Baseline]) -> Between | None:
    """The whitened move of all parameters since the history; None without a usable history."""
    found = reference(now, history)
    if found is None:
        return None
    step, covariance = found
    response = inverse_root(covariance + parameter_covariance(now))
    return Between(response @ -step, response)
