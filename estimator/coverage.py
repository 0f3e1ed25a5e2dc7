"""Coverage factors when the noise is known to a few degrees of freedom only.

Theory
------
A standard uncertainty that rests on ν degrees of freedom scatters itself. An interval y ± k·u then covers what k
promises of a normal law only if k is Student's t of the same probability: t_p(ν), p = 2Φ(k) − 1. A standard uncertainty
with components u_i of ν_i degrees of freedom has the effective ones (Welch–Satterthwaite)

    ν_eff = (Σ u_i²)² / Σ u_i⁴/ν_i,        a component that is known has ν_i = ∞

Degrees of freedom that are infinite are written as None, as in the result types.
Source: JCGM 100:2008, annex G.3 and G.4.
"""

from math import ceil

import numpy as np
from scipy.special import ndtr, ndtri, stdtr, stdtrit

LEAST = 1.0
"""Degrees of freedom that a factor is made from at least: fewer tell no variance, and Student's law of fewer has no
scale that anybody could use."""

WANTED = 5
"""Degrees of freedom to measure for: t at 95 % is then 2.57, an interval 1.31 times as long as with known noise. Four
give 1.42 times, three 1.62; a sixth saves another five per cent."""


def coverage_factor(k: float, dof: float | None) -> float:
    """The factor that covers with ``dof`` degrees of freedom what ``k`` covers when the noise is known."""
    if dof is None or np.isinf(dof):
        return k
    return float(stdtrit(max(dof, LEAST), float(ndtr(k))))


def nominal_factor(k: float, dof: float | None) -> float:
    """The factor for known noise that `coverage_factor` made ``k`` of."""
    if dof is None or np.isinf(dof):
        return k
    return float(ndtri(stdtr(max(dof, LEAST), k)))


def known_to(dof: float | None) -> float | None:
    """Degrees of freedom of a variance, `LEAST` at least; None where it is known."""
    return None if dof is None else max(dof, LEAST)


def chance(z: float, dof: float | None) -> float:
    """Probability that a normal number of mean 0 and deviation 1, Student's with ``dof`` degrees, is at most ``z``."""
    return float(ndtr(z) if dof is None else stdtr(max(dof, LEAST), z))


def combined(*parts: tuple[float, float | None]) -> float | None:
    """Effective degrees of freedom of a sum of independent parts, each a variance with its degrees of freedom."""
    total = sum(variance for variance, _ in parts)
    doubt = sum(variance**2 / max(dof, LEAST) for variance, dof in parts if dof is not None)
    return None if not doubt else total**2 / doubt


def finite(value: float) -> float | None:
    """An array's element as results write it: None where infinite or not known."""
    return float(value) if np.isfinite(value) else None


def positions_to_add(dof: int, gained: int) -> int:
    """Positions that bring ``dof`` degrees of freedom to `WANTED`, each new one giving ``gained``."""
    return max(0, ceil((WANTED - dof) / gained))
