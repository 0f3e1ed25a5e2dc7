"""Amplitudes that sessions share, fitted together, and what the fit takes from other candidates.

Theory
------
Session s has scores U_s and information F_s. The amplitudes a that all sessions share have the estimate
â = (Σ F_s,aa)⁻¹ Σ U_s,a with the covariance V = (Σ F_s,aa)⁻¹. Given them, candidates c have

    U_s|a = U_s,c − F_s,ca·â,   F|a = Σ F_s,cc − (Σ F_s,ca)·V·(Σ F_s,ac).

Sessions that took no part are predicted with N(â, V) as the prior:

    ln p(U | a) − ln p(U | none) = ½·cᵀ(V⁻¹ + F)⁻¹c − ½·âᵀV⁻¹â − ½·ln|I + V·F|,   c = V⁻¹â + U.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from estimator.least_squares import inverse
from estimator.session import Array


@dataclass(frozen=True, eq=False)
class JointFit:
    """The fit of a amplitudes to n sessions."""

    U: Array
    """(n, a) scores, 1/SI."""
    F: Array
    """(n, a, a) information, 1/SI²."""

    @cached_property
    def covariance(self) -> Array:
        """(a, a) V, SI²."""
        return inverse(self.F.sum(axis=0))

    @cached_property
    def amplitude(self) -> Array:
        """(a,) â, SI."""
        return np.asarray(self.covariance @ self.U.sum(axis=0))

    def explains(self, cross: Array) -> Array:
        """(n, …, w) part of the scores of candidates; ``cross`` (n, …, w, a) their information shared with the fit."""
        return np.asarray(cross @ self.amplitude)

    def absorbs(self, cross: Array) -> Array:
        """(…, w, w) part of the candidates' information in the pool."""
        whole = cross.sum(axis=0)
        return np.asarray(whole @ self.covariance @ np.swapaxes(whole, -1, -2))

    def predicts(self, others: "JointFit") -> float:
        """Log predictive density of other sessions that the amplitudes gain."""
        return predictive(self.amplitude, self.covariance, others.U.sum(axis=0), others.F.sum(axis=0))

    def reduces(self, others: "JointFit") -> float:
        """Reduction of the χ² of other sessions by the amplitudes."""
        a = self.amplitude
        return float(2 * a @ others.U.sum(axis=0) - a @ others.F.sum(axis=0) @ a)


def predictive(value: Array, covariance: Array, U: Array, F: Array) -> float:
    """ln p(U | amplitude ~ N(value, covariance)) − ln p(U | none), (a,) and (a, a)."""
    size = np.sqrt(np.maximum(np.diagonal(F), 1e-300))
    V, a, u, f = covariance * size[:, None] * size, value * size, U / size, F / size[:, None] / size
    off = u - f @ a
    grown = np.eye(len(a)) + V @ f
    better = a @ u - 0.5 * a @ f @ a
    return float(better + 0.5 * off @ np.linalg.solve(grown, V) @ off - 0.5 * np.linalg.slogdet(grown)[1])
