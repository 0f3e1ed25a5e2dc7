"""Noise of the readings where the file does not state it, and the check of the one it states."""

import numpy as np
from scipy import special

from estimator.forward import input_of, jacobian, projected, slope
from estimator.parameters import SensorParameters
from estimator.reference import Geometry
from estimator.session import Array

SUSPICIOUS = 1e-3
"""Below this p-value the stated noise cannot explain the residuals, and the covariance is enlarged."""

ENOUGH = 10.0
"""Degrees of freedom that a sensor needs for a noise variance of its own; with fewer, sensors of a kind share one."""


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
    steep = slope(p, geometry.n)
    left, values, _ = np.linalg.svd(jacobian(p, geometry.n, geometry.norm).swapaxes(1, 2), full_matrices=False)
    spans = left * (values > 1e-9 * values[..., :1])[..., None, :]

    def remainder(column: Array) -> Array:
        """Sum of squares (S, m) of what the fit of each sensor leaves of a (S, R, m) column."""
        c = column.swapaxes(1, 2)[..., None]
        return ((c - spans @ (spans.swapaxes(-1, -2) @ c)) ** 2).sum(axis=(-1, -2))

    squares = remainder(y / p.scale[:, None, :] - input_of(p, geometry.n))
    freedom = np.maximum(R - (spans**2).sum(axis=(-1, -2)), 0.0)
    swing = (steep * projected(p.axis, geometry.beta) * geometry.beta_sigma).swapaxes(1, 2)
    stand = (swing**2 * (1.0 - (spans**2).sum(axis=-1))).sum(axis=-1)
    for column, sigma in zip(geometry.constant, geometry.constant_sigma, strict=True):
        stand = stand + remainder(sigma * steep * projected(p.axis, column))
    left_over = np.maximum(squares - stand, 0.1 * squares)
    if freedom.min() < ENOUGH:
        alike = (geometry.norm[:, None] == geometry.norm).astype(float)
        left_over, freedom = left_over @ alike, freedom @ alike
    return np.broadcast_to((left_over / np.maximum(freedom, 1.0))[:, None, :], y.shape)


def p_value(chi2: Array, dof: Array) -> Array:
    """Probability of a χ² at least this large, element by element; 1 where nothing is left over to judge by."""
    return np.where(dof > 0, special.chdtrc(np.maximum(dof, 1), np.maximum(chi2, 0.0)), 1.0)
