"""Noise beyond the stated one: what makes the uncertainty honest when the residuals are larger than they should be.

A standard error of a mean says how well that mean is known, not how well a block set down again reads the same. Where
the stated noise cannot explain the residuals, a variance from position to position, the same for all rows and sensors
at the input, is added until χ² equals its degrees of freedom (Paule and Mandel 1982). With equal standard errors that
is the covariance times χ² per degree of freedom; with unequal ones the rows are also weighted as they deserve.
"""

from dataclasses import replace

import numpy as np
from scipy.optimize import brentq
from scipy.stats import chi2 as chi_squared

from estimator.calibration.free.solve import Solution, search

UNLIKELY = 1e-3
"""p-value below which the stated noise does not explain the residuals."""

SETTLED = 1e-3
"""Relative accuracy of the added sigma."""


def p_value(chi2: float, dof: int) -> float | None:
    """Probability of a χ² at least this large; None without degrees of freedom."""
    return float(chi_squared.sf(chi2, dof)) if dof > 0 else None


def explained(solution: Solution) -> Solution:
    """The solution under noise that explains its residuals; itself where the stated noise does."""
    p = p_value(solution.chi2, solution.dof)
    if p is None or p >= UNLIKELY:
        return solution
    found = {0.0: solution}

    def surplus(log_sigma: float) -> float:
        added = np.exp(solution.state.log_scale + log_sigma)
        trial = search(solution.rows.weighted(np.hypot(solution.rows.sigma, added)), solution.state, solution.quadratic)
        found[log_sigma] = trial
        return trial.chi2 / solution.dof - 1.0

    usual = float(np.log(np.median(solution.rows.sigma)))
    low, high = usual - 3.0, usual + 0.5 * np.log(solution.chi2 / solution.dof) + 1.0
    while surplus(high) > 0:
        high += 1.0
    root = low if surplus(low) < 0 else brentq(surplus, low, high, xtol=SETTLED)
    surplus(root)
    return replace(found[root], iterations=solution.iterations)
