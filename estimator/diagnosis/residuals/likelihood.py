"""Restricted likelihood of a session's readings under a noise, whatever its parameters are.

Theory
------
Residuals of one row have the covariance D + H S H', and design X holds what the parameters and constant nuisances do.
With all of X of no prior knowledge, the restricted likelihood (Patterson & Thompson 1971, Biometrika 58, 545) is

    ln L = −½ z'z − ½ Σ ln |D + H S H'| − ½ ln |X' V⁻¹ X|

with z the whitened residuals outside X. A nuisance of which nothing is known (S infinite) counts as a column of X. Too
small a noise of one sensor shows in all of them: what they share of a row, its β error, is then read off that sensor.
"""

import numpy as np

from estimator.diagnosis.residuals.baseline import RANK, Baseline, turn_response
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.session import Array


def log_likelihood_ratio(first: WhitenedResiduals, other: WhitenedResiduals) -> float:
    """ln of the restricted likelihood of the readings, and of their change since the history, in ``first`` over
    ``other``: the same session under two noises, dimensionless."""
    scale = np.linalg.norm(other.baseline.whitened_design, axis=0)
    scale = np.where(scale > 0, scale, 1.0)
    return restricted(first, scale) - restricted(other, scale)


def restricted(residuals: WhitenedResiduals, scale: Array) -> float:
    """ln L up to a constant that does not depend on the noise; ``scale`` (5 m + k,) any unit of each column."""
    design = without_turn(residuals.baseline, scale)
    value = -0.5 * float(residuals.z @ residuals.z) - log_size(design) + row_determinants(residuals.baseline)
    return value if residuals.change is None else value + log_size(residuals.change.inverse_root)


def without_turn(baseline: Baseline, scale: Array) -> Array:
    """(N, 5 m + k) the whitened design in units ``scale`` of its columns, without the common turn of axes that nothing
    observes: in noise of other shares it would leave a trace of rounding and curvature, and change the rank."""
    design = baseline.whitened_design / scale
    if not baseline.gauge_free.any():
        return np.asarray(design)
    P = 5 * len(baseline.gauge_free)
    turn, _ = np.linalg.qr(
        turn_response(baseline.parameters) * (np.repeat(baseline.gauge_free, 5) * scale[:P])[:, None]
    )
    return np.concatenate([design[:, :P] - (design[:, :P] @ turn) @ turn.T, design[:, P:]], axis=1)


def log_size(matrix: Array) -> float:
    """ln of the product of a matrix' singular values that are not zero."""
    size = np.linalg.svd(matrix, compute_uv=False)
    return float(np.log(size[size > RANK * size[0]]).sum())


def row_determinants(baseline: Baseline) -> float:
    """−½ Σ ln |D + H S H'| over the rows, that of S left out where nothing is known of it."""
    weight, unknown = 1.0 / np.sqrt(baseline.variance), np.isinf(baseline.row_sigma)
    sigma = np.where(unknown, 1.0, baseline.row_sigma)
    size = np.linalg.svd(baseline.row * weight[..., None] * sigma[:, None, :], compute_uv=False)
    acts = size > RANK * np.maximum(size[:, :1], np.finfo(float).tiny)
    free = unknown.any(axis=1, keepdims=True) & acts
    spread = np.where(free, np.log(np.where(free, size, 1.0)), 0.5 * np.log1p(size**2))
    return float(np.log(weight).sum() - spread.sum())
