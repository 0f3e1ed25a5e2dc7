"""Noise beyond the stated one: what makes the uncertainty honest when the residuals are larger than they should be.

A standard error of a mean says how well that mean is known, not how well a block set down again reads the same. Where
the stated noise cannot explain the residuals, a variance from position to position, the same for all rows and sensors
at the input, is added until χ² equals its degrees of freedom (Paule and Mandel 1982). With equal standard errors that
is the covariance times χ² per degree of freedom; with unequal ones the rows are also weighted as they deserve.
"""

from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from estimator.calibration.free.model import WEIGHTLESS, predicted
from estimator.calibration.free.solve import Solution, search
from estimator.session import Array
from estimator.significance import p_value

UNLIKELY = 1e-3
"""p-value below which the stated noise does not explain the residuals: true noise is mistrusted once in a thousand
sessions."""

SETTLED = 1e-3
"""Relative accuracy of the added sigma: far below what residuals tell of a sigma."""

ROUNDS = 12
"""Rounds of search and noise; a handful is usual, and the last is taken where they do not settle."""

NARROWEST = 12.0
"""ln of the ratio of the largest to the smallest sigma that is looked for: six orders, beyond any reading's noise."""


def explained(solution: Solution) -> Solution:
    """The solution under noise that explains its residuals; itself where the stated noise does."""
    if p_value(solution.chi2, solution.dof) >= UNLIKELY:
        return solution
    stated, current, last = solution.rows.sigma, solution, np.inf
    for _ in range(ROUNDS):
        added = added_noise(current, stated, solution.dof)
        sigma = np.hypot(stated, added * np.exp(current.unknowns.log_scale))
        current = search(solution.rows.weighted(sigma), current.unknowns, solution.quadratic)
        if abs(added - last) < SETTLED * added or not current.converged:
            break
        last = added
    return replace(current, iterations=solution.iterations, freedom=float(solution.dof))


def added_noise(solution: Solution, stated: Array, dof: int) -> float:
    """Sigma at the input, in g, that brings χ² of the residuals as they are to its degrees of freedom.

    stated : (R, m) one sigma of the readings, relative to nominal scale times g.
    """
    gain = np.exp(solution.unknowns.log_scale)
    squares = np.where(stated < WEIGHTLESS, (solution.rows.y - predicted(solution.unknowns)) ** 2, 0.0)
    turned = solution.rows.prior[:, None] * (solution.rows.directions - solution.unknowns.directions) ** 2

    def surplus(log_sigma: float) -> float:
        variance = stated**2 + (np.exp(log_sigma) * gain) ** 2
        return float((squares / variance).sum() + turned.sum()) / dof - 1.0

    high = 0.5 * float(np.log((squares / gain**2).sum() / dof)) + 1.0
    low = high - NARROWEST
    if surplus(low) <= 0 or surplus(high) >= 0:
        return float(np.exp(low if surplus(low) <= 0 else high))
    return float(np.exp(brentq(surplus, low, high, xtol=SETTLED)))
