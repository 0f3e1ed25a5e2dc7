"""Noise of the readings where the file does not state it, and the check of the one it states."""

import numpy as np
from scipy import stats

from estimator.calibration.refine import linearise
from estimator.forward import jacobian, projected, slope
from estimator.parameters import SensorParameters
from estimator.reference import Geometry
from estimator.session import Array

SUSPICIOUS = 1e-3
"""Below this p-value the stated noise cannot explain the residuals, and the covariance is enlarged."""


def estimated_variance(y: Array, p: SensorParameters, geometry: Geometry) -> Array:
    """Variance of each sensor's readings from its own residuals, the stand's known share taken off.

    A moment estimate (MINQUE): the expectation of the residual sum of squares of a five-parameter fit is
    σ²·(R − rank) plus what the stand's errors, of stated sigma, leave behind; solved for σ².

    Parameters
    ----------
    y : (S, R, m); p : (S, m), close to the solution.

    Returns
    -------
    (S, R, m) at the input, constant over the rows; at least a tenth of the raw mean square.
    """
    R = y.shape[1]
    _, residual = linearise(y, p, geometry, np.ones_like(y))
    J = np.swapaxes(jacobian(p, geometry.n, geometry.norm), 1, 2)
    steep = slope(p, geometry.n)
    left, values, _ = np.linalg.svd(J, full_matrices=False)
    spans = left * (values > 1e-9 * values[..., :1])[..., None, :]

    def remainder(column: Array) -> Array:
        """Squares (S, m, R) of what the fit of each sensor leaves of a (S, R, m) column."""
        c = np.swapaxes(column, 1, 2)[..., None]
        return ((c - spans @ (spans.swapaxes(-1, -2) @ c))[..., 0]) ** 2

    rss = remainder(residual).sum(axis=-1)
    freedom = np.maximum(R - (spans**2).sum(axis=(-1, -2)), 1.0)
    stand = np.zeros_like(rss)
    for column, sigma in zip(geometry.constant, geometry.constant_sigma, strict=True):
        stand = stand + sigma**2 * remainder(steep * projected(p.axis, column)).sum(axis=-1)
    open_rows = 1.0 - (spans**2).sum(axis=-1)
    beta = np.swapaxes(steep * projected(p.axis, geometry.beta), 1, 2)
    stand = stand + geometry.beta_sigma**2 * (open_rows * beta**2).sum(axis=-1)
    variance = np.maximum(rss - stand, 0.1 * rss) / freedom
    tiny = (np.finfo(float).eps * geometry.norm) ** 2
    return np.broadcast_to(np.maximum(variance, tiny)[:, None, :], y.shape)


def p_value(chi2: float, dof: int) -> float:
    """Probability of a χ² at least this large."""
    return float(stats.chi2.sf(chi2, dof)) if dof > 0 else 1.0
