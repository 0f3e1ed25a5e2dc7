"""The information of a session on whatever changes its inputs, and how it shrinks as terms are added.

Theory
------
Whitened residuals z are linear in a change x of the inputs of all readings and of the parameters that the history
holds: z = T·x + e, e ~ N(0, 1). All that inference needs is A = T'T, a = T'z and E = z'z. A term x = W·(μ + u), with
u ~ N(0, V), explains

    Δ = 2μ'W'a − μ'W'AWμ + b'(V⁻¹ + W'AW)⁻¹b,      b = W'(a − AWμ),      ln B = ½Δ − ½ ln|1 + V W'AW|

and leaves for other terms A − AW(V⁻¹ + W'AW)⁻¹W'A, likewise of a, and E − Δ (MacKay 2003, 28; Rasmussen & Williams
2006, 2.2). A sensor's own cause touches the block of its own readings only, so that the scores of all its shapes are
one product with that block. Where the scale of the noise is not stated, −½ν ln(1 − Δ/E) takes the place of ½Δ, ν the
degrees of freedom of E (O'Hagan & Forster 2004, 11.3).
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.special import gammaln

from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.session import Array

SCALES = float(np.log(1e6))
"""ln of the range that the scale of a noise that is not stated may lie in."""

LEAST = 1e-6
"""Share of the energy that stays noise at least."""


@dataclass(frozen=True, eq=False)
class InputInformation:
    """Knowledge of a change of the inputs. D = R·m readings and P parameters of the history (0 without one)."""

    A: Array
    """(D, D) per (m/s²)² ((rad/s)²), of the P last dimensionless."""
    a: Array
    """(D,) per m/s² (rad/s), of the P last dimensionless."""
    energy: float
    freedom: float
    scaled: bool
    """Whether the scale of the noise is not stated, of most sensors."""

    @classmethod
    def of(cls, residuals: WhitenedResiduals) -> tuple["InputInformation", Array]:
        """The information with nothing found, and T (n, D)."""
        R, m = residuals.baseline.residual.shape
        T = residuals.trace(np.eye(R * m).reshape(R, m, R * m), 0.0)
        if residuals.change is not None:
            P = len(residuals.change.deviation)
            T = np.concatenate([T, np.zeros((len(T), P))], axis=1)
            T[residuals.rows :, R * m :] = -residuals.change.inverse_root
        z = residuals.z
        freedom = float(residuals.freedom + len(z) - residuals.rows)
        return cls(
            T.T @ T,
            T.T @ z,
            float(z @ z),
            freedom,
            bool(2 * residuals.baseline.unstated.sum() > len(residuals.baseline.unstated)),
        ), T

    def gained(self, explained: Array | float) -> Array:
        """ln likelihood ratio of residuals whose energy is less by ``explained``, of any shape."""
        if not self.scaled:
            return np.asarray(0.5 * np.asarray(explained))
        return np.asarray(-0.5 * self.freedom * np.log1p(-np.minimum(explained / self.energy, 1 - LEAST)))

    @property
    def log_scale_free(self) -> float:
        """ln of the likelihood with the scale of the noise integrated out, over that at the scale taken: ½Γ(ν/2)
        (E/2)^(−ν/2) e^(E/2), the scale being log-uniform over `SCALES`; 0 where it is stated."""
        if not self.scaled:
            return 0.0
        half, energy = 0.5 * self.freedom, 0.5 * self.energy
        return float(gammaln(half) - half * np.log(energy) + energy - np.log(2 * SCALES))

    def given(self, W: Array, variance: Array, mean: Array | None = None) -> tuple["InputInformation", float]:
        """The information left beside a term of columns ``W`` (D, q) whose amplitudes have ``variance`` (q,) and
        ``mean``, and its ln B."""
        AW, a, explained = self.A @ W, self.a, 0.0
        gram = W.T @ AW
        if mean is not None:
            explained = float(2 * mean @ (W.T @ a) - mean @ gram @ mean)
            a = a - AW @ mean
        b = W.T @ a
        gain = np.linalg.solve(np.diag(1 / variance) + gram, np.concatenate([AW.T, b[:, None]], axis=1))
        explained += float(b @ gain[:, -1])
        size = np.linalg.slogdet(np.eye(len(variance)) + variance[:, None] * gram)[1]
        energy = max(self.energy - explained, LEAST * self.energy)
        left = replace(self, A=self.A - AW @ gain[:, :-1], a=a - AW @ gain[:, -1], energy=energy)
        return left, float(self.gained(explained) - 0.5 * size)

    def log_evidence_of(self, gram: Array, along: Array, sizes: Array, fixed: Array | float = 0.0) -> Array:
        """(S, L) ln B of S terms of q amplitudes, each N(0, s²), for L ``sizes`` s.

        ``gram`` (S, q, q) and ``along`` (S, q): W'AW and W'a, per unit of size; ``fixed`` (S,) what a mean of the
        amplitudes explains.
        """
        if gram.shape[-1] == 1:
            d, b = np.maximum(gram[:, 0], 0.0), along**2
        else:
            d, turn = np.linalg.eigh(gram)
            d, b = np.maximum(d, 0.0), (along[:, None, :] @ turn)[:, 0] ** 2
        g = (sizes**2)[:, None]
        grown = 1 + g * d[:, None, :]
        explained = (g * b[:, None, :] / grown).sum(axis=-1) + np.broadcast_to(fixed, len(gram))[:, None]
        return self.gained(explained) - 0.5 * np.log(grown).sum(axis=-1)
