"""What moved since the history: the parameters of earlier sessions as one reference with covariance.

In arbitrary orientations the applied vectors are estimated, so a common turn of all axes cannot be observed: earlier
axes are turned onto those of now first, and only what is orthogonal to a common turn is compared.
"""

from collections.abc import Sequence

import numpy as np

from estimator.arrays import nearest_turn, tangents
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.gauge import observable_directions
from estimator.diagnosis.residuals.whitened import (
    EarlierSession,
    ParameterChange,
    WhitenedResiduals,
    parameter_covariance,
)
from estimator.session import Array

NO_VARIANCE = 1e-13
"""Variance over the largest (each parameter in its own sigma) below which a direction has none: rounding of a
correlation matrix of some hundred parameters."""


def seen_from(now: Baseline, earlier: Baseline) -> tuple[Array, Array]:
    """Parameters of an earlier session seen from now: dimensionless deviation (P,) and how they map there (P, P)."""
    p, q, norm = now.parameters, earlier.parameters, now.setting.norm
    m = len(norm)
    turned = nearest_turn(q.axis, p.axis) if now.gauge_free.any() else np.eye(3)
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
    """W (P, P), symmetric up to scale, with W'W the pseudo-inverse of a dimensionless covariance (P, P)."""
    scale = np.sqrt(np.diagonal(matrix))
    values, vectors = np.linalg.eigh(matrix / scale[:, None] / scale)
    kept = values > NO_VARIANCE * values[-1]
    inverse = np.where(kept, 1 / np.sqrt(np.where(kept, values, 1.0)), 0.0)
    return np.asarray((vectors * inverse) @ vectors.T / scale)


def parameter_change(now: Baseline, history: Sequence[Baseline]) -> ParameterChange | None:
    """The whitened change of all parameters since the history; None without a usable history.

    The reference is the information-weighted mean of the history's parameters.
    """
    keep = observable_directions(now.gauge_free, now.parameters)
    alike = [h for h in history if h.setting.kinds == now.setting.kinds]
    if not alike:
        return None
    steps, maps = zip(*(seen_from(now, earlier) for earlier in alike), strict=True)
    known = [keep.T @ turn @ parameter_covariance(h) @ turn.T @ keep for h, turn in zip(alike, maps, strict=True)]
    information = [(root := inverse_root(covariance)).T @ root for covariance in known]
    covariance = (root := inverse_root(np.sum(information, axis=0))).T @ root
    shares = [keep @ covariance @ own @ keep.T for own in information]
    whiten = keep @ inverse_root(covariance + keep.T @ parameter_covariance(now) @ keep) @ keep.T
    step = np.sum([share @ step for share, step in zip(shares, steps, strict=True)], axis=0)
    earlier = [
        EarlierSession(WhitenedResiduals.of(h), w @ turn) for h, w, turn in zip(alike, shares, maps, strict=True)
    ]
    return ParameterChange(whiten @ -step, whiten, tuple(earlier))
