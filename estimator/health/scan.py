"""The number of independent looks that a scan over neighbouring dates is worth.

Scores at neighbouring dates rest on mostly the same sessions, so that n of them are fewer chances to be misled than n.
For standard normal vectors u_i of k components, each correlated with the next by ρ_i, the chance that any is long is

    P(max |u_i|² > x) ≤ P(|u_1|² > x) + Σ P(|u_i|² ≤ x < |u_{i+1}|²)

(Hunter 1976, J. Appl. Probab. 13, 597; Worsley 1982, Biometrika 69, 297), with s² = 1 − ρ² and u_{i+1} = ρ·u_i + s·e

    P(|u_i|² ≤ x < |u_{i+1}|²) = ∫_0^√x f_k(r) E_q[Φ((ρr − h)/s) + Φ((−ρr − h)/s)] dr,    h² = x − s²q, q ~ χ²(k − 1),

f_k the density of a length of k components. Both over P(|u|² > x) is what Bonferroni's count may be replaced by; it is
taken at the x that a count of n would ask for, beyond which it is a little larger and nothing is decided.
"""

import numpy as np
from scipy.special import gammaln, ndtr, roots_genlaguerre, xlogy

from estimator.session import Array
from estimator.significance import critical_chi2

NODES, WEIGHTS = np.polynomial.legendre.leggauss(48)
"""(48,) nodes and weights of the integral over r, dimensionless; right to a relative 1e-4."""
ACROSS = 16
"""Nodes of q, which only bends the edge: right to 1e-3 from ρ = ½ on, to a twentieth where scores are independent."""
REACH = 8.0
"""Standard deviations s that the next score may lie further out than this one (1e-15)."""
ALIKE = 1.0 - 1e-9
"""Largest correlation; beyond it two dates are one."""


def looks(correlation: Array, size: int, level: float) -> float:
    """The number of looks that n scores of ``size`` components are worth, at a ``level`` over all of them.

    correlation : (n − 1,) ρ of each score with the next, dimensionless.
    """
    n = len(correlation) + 1
    single = level / n
    limit = critical_chi2(single, size)
    return min(1 + float(_crossings(np.clip(correlation, 0.0, ALIKE), size, limit).sum()) / single, float(n))


def _crossings(correlation: Array, size: int, limit: float) -> Array:
    """(n − 1,) chances that one score is within the limit and the next is not."""
    rho, edge = correlation[:, None], np.sqrt(limit)
    s = np.sqrt(1 - rho**2)
    start = np.maximum(edge - REACH * s, 0.0)
    r = start + (edge - start) * (NODES + 1) / 2
    q, share = _across(size)
    height = np.sqrt(np.maximum(limit - s[..., None] ** 2 * q, 0.0))
    along = (rho * r)[..., None]
    beyond = (ndtr((along - height) / s[..., None]) + ndtr((-along - height) / s[..., None])) @ share
    density = np.exp(xlogy(size - 1, r) - r**2 / 2 - (size / 2 - 1) * np.log(2) - gammaln(size / 2))
    return np.asarray(((edge - start) / 2 * WEIGHTS * density * beyond).sum(axis=1))


def _across(size: int) -> tuple[Array, Array]:
    """Nodes (n,) of χ² of size − 1 with their weights (n,), dimensionless."""
    if size == 1:
        return np.zeros(1), np.ones(1)
    nodes, weights = roots_genlaguerre(ACROSS, (size - 1) / 2 - 1)
    return 2 * nodes, weights / weights.sum()
