"""The decision rule: four states with a guard band, the honest fifth, and the level that a whole session keeps.

Four states (ILAC-G8:2019, JCGM 106:2012), y the deviation, T the tolerance, U = k·u, guard band w = U:

    pass              |y| + w ≤ T
    conditional-pass  |y| ≤ T < |y| + w
    conditional-fail  |y| − w ≤ T < |y|
    fail              |y| − w > T
    undecidable       U > T, or the session does not observe the parameter or cannot tell its noise

Where the noise is known to ν effective degrees of freedom only, k is Student's t of the probability that the stated k
has for known noise (`estimator.coverage`).

With w = k·u a parameter whose true deviation is T passes, and fails, with probability Φ(−k) at most (2.3 % for k = 2),
k the one for known noise.

The level of a session
----------------------
A session judges n deviations. One whose U just equals T exceeds its tolerance by chance alone with probability
2Φ(−2) = 4.6 % although nothing moved; among n = 24 that happens in two sessions of three. So a number may be called out
of tolerance, conditionally or not, only if it differs from zero at all at the level α = 1 % of the whole session:

    |y_i| > q_n·u_i,    2Φ(−q_n) = α_n = 1 − (1 − α)^{1/n}

Otherwise it is `undecidable`: beyond the tolerance, but no more than noise makes the largest of n numbers. An axis
deviation is a two-vector d with covariance Σ; there the condition is dᵀΣ⁻¹d > −2 ln α_n. If the noise was estimated
from ν residual degrees of freedom, Student's t and Fisher's F take the place of the normal and chi-square.

Why that suffices: the n acceptance regions are convex and symmetric about zero. By the Gaussian correlation inequality
(Royen 2014; Šidák 1967 for intervals) the probability that all n vectors fall inside is at least the product of their
probabilities, (1 − α_n)^n = 1 − α, however they are correlated, as they are through the stand. A unit exactly at its
reference is therefore called conditional-fail or fail in at most 1 % of its sessions. Both sides of the guard band are
untouched: `pass` needs |y| + U ≤ T as before, and `fail` still needs |y| − U > T.
"""

from collections.abc import Mapping
from functools import cache

from estimator.significance import critical_chi2, single_level

PASS = "pass"
CONDITIONAL_PASS = "conditional-pass"
UNDECIDABLE = "undecidable"
CONDITIONAL_FAIL = "conditional-fail"
FAIL = "fail"
RULE = "ILAC-G8-four-state/3"
"""2: what all sensors of the block did together is taken off before a sensor is judged. 3: k by Student's t."""
WITH_SESSION_LEVEL = ("ILAC-G8-four-state/2", RULE)
"""Versions that keep the level of the whole session, for papers of what was decided before."""
SESSION_LEVEL = 0.01
"""α: one false alarm in a hundred sessions of a unit that has not changed."""


def tolerance_of(tolerances: Mapping[tuple[str, str], float], sensor: str, kind: str, parameter: str) -> float | None:
    """T of a parameter, relative for scale, else SI: the sensor's own, else that of its kind; None without one."""
    return tolerances.get((sensor, parameter), tolerances.get((kind, parameter)))


def state(size: float, expanded: float, tolerance: float, critical: float) -> str:
    """The state of one deviation.

    Parameters
    ----------
    size : |y|.
    expanded : U, unit of y.
    tolerance : T, unit of y.
    critical : smallest |y| that counts as a change at the level of the session, unit of y.
    """
    if expanded > tolerance:
        return UNDECIDABLE
    if size + expanded <= tolerance:
        return PASS
    if size <= tolerance:
        return CONDITIONAL_PASS
    if size <= critical:
        return UNDECIDABLE
    return FAIL if size - expanded > tolerance else CONDITIONAL_FAIL


@cache
def critical_factors(judged: int, dof: float | None = None, level: float = SESSION_LEVEL) -> tuple[float, float]:
    """Factors of the standard uncertainty beyond which a scalar, and a two-vector (Mahalanobis length), is a change.

    Parameters
    ----------
    judged : n, deviations that the session judges; an axis counts as one.
    dof : effective degrees of freedom of the deviation; None when the noise is known.
    level : α of the whole session.
    """
    single = single_level(level, judged)
    return critical_chi2(single, 1, dof) ** 0.5, critical_chi2(single, 2, dof) ** 0.5
