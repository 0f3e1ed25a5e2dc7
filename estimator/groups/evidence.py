"""Evidence that holds however often one looks: Bayes factors that are e-processes.

Theory
------
An amplitude with the prior N(0, κ²·F₁⁻¹), F₁ the information of the first session that sees the candidate, has after
sessions with score U and information F the Bayes factor against no effect

    B = |I + κ²·F₁⁻¹·F|^(−½)·exp(½·Uᵀ(F + F₁/κ²)⁻¹U),

whose expectation without the effect is one at whatever session one stops (F₁ is fixed beforehand, whatever is read).
So is the mean of such factors over κ, over every hypothesis, and over three forms that an effect may have: always the
same; there, but different every time (a_s ~ N(0, τ²·F_s⁻¹), a product over sessions); and since one of the sessions.
By Ville's inequality the chance that the mean ever reaches 1/α without an effect is at most α (Ville 1939; Vovk & Wang
2021, Annals of Statistics 49, 1736; Grünwald, de Heide & Koolen 2024, JRSS B 86, 1091).
"""

import numpy as np

from estimator.groups.priors import GROWTH, SPREADS, STRENGTHS
from estimator.least_squares import scale_of
from estimator.session import Array

FAINT = 0.03
"""Added to F₁ in units of its own diagonal, where there are several amplitudes: a combination of them that a session
hardly sees is known to the steps of the kept correlations only, and would be evidence of rounding."""


def log_sum(values: Array) -> Array:
    """ln Σ exp over the first axis, any shape: `scipy.special.logsumexp` says the same and takes ten times as long."""
    return np.asarray(np.logaddexp.reduce(values, axis=0))


def log_bayes(U: Array, F: Array, first: Array) -> Array:
    """(…, H) ln B, mean over κ; ``U`` (…, H, w), ``F`` (…, H, w, w), ``first`` (…, H, w, w) F₁.

    0 where nothing is seen.
    """
    scale, w = scale_of(first), U.shape[-1]
    unit = first * scale[..., :, None] * scale[..., None, :] + (FAINT if w > 1 else 1e-6) * np.eye(w)
    grown, along = F * scale[..., :, None] * scale[..., None, :], U * scale
    values = []
    for kappa in STRENGTHS:
        prior = unit / kappa**2
        total = grown + prior
        if w == 1:
            fit, volume = along[..., 0] ** 2 / total[..., 0, 0], np.log(total[..., 0, 0] / prior[..., 0, 0])
        else:
            fit = (along * np.linalg.solve(total, along[..., None])[..., 0]).sum(axis=-1)
            volume = np.linalg.slogdet(total)[1] - np.linalg.slogdet(prior)[1]
        values.append(0.5 * fit - 0.5 * volume)
    return np.where((scale > 0).any(axis=-1), log_sum(np.array(values)) - np.log(len(STRENGTHS)), 0.0)


def log_varying(statistic: Array, freedom: Array) -> Array:
    """(H,) ln of the product over sessions of their factors of an effect that differs every time, mean over τ.

    ``statistic`` (H,) sum of the sessions' χ², ``freedom`` (H,) of their degrees of freedom.
    """
    values = [0.5 * statistic * t**2 / (1 + t**2) - 0.5 * freedom * np.log1p(t**2) for t in SPREADS]
    return log_sum(np.array(values)) - float(np.log(len(SPREADS)))


def beginnings(sessions: int) -> list[int]:
    """Sessions, counted from 0, at which an effect is tried to begin after the first."""
    at = 1.0
    found: list[int] = []
    while at < sessions:
        if not found or int(at) > found[-1]:
            found.append(int(at))
        at = max(at * GROWTH, at + 1)
    return found


def log_since(U: Array, F: Array) -> Array:
    """(K, H) ln B of an effect that began at each of K `beginnings`, prior share of the beginning included.

    ``U`` (n, H, w) and ``F`` (n, H, w, w) of sessions. F₁ is that of the first session after the beginning.
    """
    n = len(U)
    starts = beginnings(n)
    if not starts:
        return np.full((0, U.shape[1]), -np.inf)
    after_U, after_F = (np.cumsum(x[::-1], axis=0)[::-1] for x in (U, F))
    first = np.stack([first_seen(F[k:]) for k in starts])
    j = np.arange(len(starts))[:, None]
    return log_bayes(after_U[starts], after_F[starts], first) - np.log((j + 1) * (j + 2))


def first_seen(F: Array) -> Array:
    """(H, w, w) the first information of each hypothesis that is not nothing; ``F`` (n, H, w, w)."""
    seen = np.diagonal(F, axis1=-2, axis2=-1).sum(axis=-1) > 0
    return np.asarray(F[seen.argmax(axis=0), np.arange(F.shape[1])])
