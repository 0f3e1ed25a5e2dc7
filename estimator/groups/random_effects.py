"""An amplitude over sessions: common, or scattered about a mean.

Theory
------
Session s estimates a_s with information F_s; a_s = a + δ_s, cov δ = τ²·I. With V_s = F_s⁻¹ + τ²·I the mean is
â = (Σ V_s⁻¹)⁻¹ Σ V_s⁻¹ a_s; V_s⁻¹ = F_s (I + τ² F_s)⁻¹ and V_s⁻¹ a_s = (I + τ² F_s)⁻¹ U_s, so that no session needs
to see every amplitude. The τ² reported is that of Mandel and Paule: Q(τ²) = Σ (a_s − â)ᵀ V_s⁻¹ (a_s − â) equals its
degrees of freedom (Paule & Mandel 1982, J. Res. NBS 87, 377); Q(0) is Cochran's test (1954, Biometrics 10, 101). Of
few sessions τ is hardly known, and a mean at one value of it is too sure. So mean and sigma are those over the
restricted likelihood of τ, its prior a half-Cauchy of one session's sigma (Gelman 2006, Bayesian Analysis 1, 515).
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from estimator.least_squares import inverse
from estimator.session import Array
from estimator.significance import p_value

TAUS = np.concatenate([[0.0], np.geomspace(0.05, 100.0, 48)])
"""τ in units of one session's sigma: below, sessions are alike to a part in a thousand; above, only τ counts."""


@dataclass(frozen=True, eq=False)
class Mean:
    """The amplitude of a group: n sessions, w amplitudes."""

    value: Array
    """(w,) SI."""
    sigma: Array
    """(w,) SI; 0 of an amplitude that no session sees."""
    covariance: Array
    """(w, w) SI², of the value."""
    spread: float
    """τ, SI: between sessions; 0 where the sessions differ by no more than their noise."""
    cochran: float
    """p-value of Q(0): chance that sessions of one amplitude differ so much."""


def mean_of(U: Array, F: Array) -> Mean:
    """The mean amplitude from sessions' scores U (n, w), 1/SI, and information F (n, w, w), 1/SI²."""
    largest = float(np.sqrt(np.median(np.diagonal(F, axis1=1, axis2=2).max(axis=1))))
    u, f = U / largest, F / largest**2
    freedom = int(np.linalg.matrix_rank(f, tol=1e-6, hermitian=True).sum())
    freedom -= int(np.linalg.matrix_rank(f.sum(axis=0), tol=1e-6, hermitian=True))
    chi2 = float((u * (np.linalg.pinv(f, rcond=1e-6, hermitian=True) @ u[..., None])[..., 0]).sum())
    q = _heterogeneity(u, f, 0.0, chi2)
    p = float(p_value(q, freedom))
    spread = np.sqrt(_mandel_paule(u, f, freedom, chi2)) if freedom > 0 and q > freedom else 0.0
    alone = inverse(f.sum(axis=0))
    value, covariance = _over_spreads(u, f) if freedom > 0 else (alone @ u.sum(axis=0), alone)
    covariance = covariance / largest**2
    return Mean(value / largest, np.sqrt(np.diagonal(covariance)), covariance, float(spread) / largest, p)


def _over_spreads(u: Array, f: Array) -> tuple[Array, Array]:
    """(w,) mean and (w, w) covariance over the restricted likelihood of τ.

    Its ln is ½·(τ²·Σ uᵀ(I + τ²F)⁻¹u + âᵀ(Σ V⁻¹)â − Σ ln|I + τ²F| − ln|Σ V⁻¹|), but for a constant.
    """
    tau2 = TAUS[:, None, None, None] ** 2
    grown = np.eye(u.shape[1]) + tau2 * f
    shrink = np.linalg.inv(grown)
    weighted = (shrink @ u[..., None])[..., 0]
    total, whole = (f @ shrink).sum(axis=1), weighted.sum(axis=1)
    covariance = np.linalg.pinv(total, rcond=1e-9, hermitian=True)
    value = (covariance @ whole[..., None])[..., 0]
    explained = (TAUS**2 * (u * weighted).sum(axis=(1, 2))) + (whole * value).sum(axis=1)
    kept = np.linalg.eigvalsh(total)
    seen = kept > 1e-9 * kept[:, -1:]
    cost = np.linalg.slogdet(grown)[1].sum(axis=1) + np.where(seen, np.log(np.where(seen, kept, 1.0)), 0.0).sum(axis=1)
    likelihood = 0.5 * (explained - cost)
    share = np.gradient(TAUS) / (1 + TAUS**2) * np.exp(likelihood - likelihood.max())
    share = share / share.sum()
    mean = share @ value
    apart = value - mean
    spread = covariance + apart[:, :, None] * apart[:, None, :]
    return mean, np.asarray((share[:, None, None] * spread).sum(axis=0))


def _heterogeneity(u: Array, f: Array, tau2: float, alone: float) -> float:
    """Q at a τ²; ``alone`` is Σ uᵀF⁻¹u. It uses F⁻¹(I + τ²F)⁻¹ = F⁻¹ − τ²(I + τ²F)⁻¹."""
    shrink = np.linalg.inv(np.eye(u.shape[1]) + tau2 * f)
    W, weighted = f @ shrink, (shrink @ u[..., None])[..., 0]
    total = weighted.sum(axis=0)
    return float(alone - tau2 * (u * weighted).sum() - total @ inverse(W.sum(axis=0)) @ total)


def _mandel_paule(u: Array, f: Array, freedom: int, alone: float) -> float:
    """τ² at which Q is its degrees of freedom."""
    high = 1.0
    while _heterogeneity(u, f, high, alone) > freedom:
        high *= 10.0
    return float(brentq(lambda t: _heterogeneity(u, f, t, alone) - freedom, 0.0, high, rtol=1e-6))
