"""Laws that errors of measurement may follow: Student's of ν degrees of freedom with the stated standard deviation."""

import numpy as np
from scipy.special import gammaln

from estimator.session import Array

FREEDOMS = np.array([np.inf, 10.0, 5.0, 3.5])
"""(4,) ν: none, hardly any, plain and heavy tails; below it a stated standard deviation means little."""
USUAL = np.array([0.97, 0.01, 0.01, 0.01])
"""(4,) chance of each in workshops in general: errors are averages of many readings, mostly normal."""
NORMAL = np.array([1.0, 0.0, 0.0, 0.0])
"""(4,) weights where all errors are normal."""


def log_density(z: Array, freedom: float) -> Array:
    """Log of the density of errors in units of their standard deviation; the shape of z, dimensionless."""
    if np.isinf(freedom):
        return np.asarray(-0.5 * z**2 - 0.5 * np.log(2 * np.pi))
    scale2 = freedom - 2
    constant = gammaln((freedom + 1) / 2) - gammaln(freedom / 2) - 0.5 * np.log(np.pi * scale2)
    return np.asarray(constant - (freedom + 1) / 2 * np.log1p(z**2 / scale2))


def drawn(freedom: float, shape: tuple[int, ...], rng: np.random.Generator) -> Array:
    """Errors of a finite ν in units of their standard deviation."""
    return np.asarray(rng.standard_t(freedom, shape) * np.sqrt((freedom - 2) / freedom))
