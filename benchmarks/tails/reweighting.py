"""A rival of the forecast: what every session is worth where errors have tails.

An error with Student's law of ν degrees of freedom and the stated standard deviation σ is normal given how good its
session was, λ (Andrews & Mallows 1974; Lange, Little & Taylor 1989):

    e ~ N(0, σ²(ν − 2)/(νλ)),    λ ~ Gamma(ν/2, ν/2)

Given all that a history may be (`posterior`), the law of λ is gamma again, and a session counts with the precision

    E[ν·λ/((ν − 2)·σ²)] = κ/σ²,    κ = Σ_ν p_ν·(ν + 1)/(ν − 2 + ρ),    ρ = E[e²]/σ²

p_ν the type's chance of each law; of normal errors κ = 1. Both laws in turn, of λ and of all else, are a mean-field
approximation of their joint law (Tipping & Lawrence 2005), which takes λ for known: it counts the information on a
level as E[κ]/σ² = ν/(ν − 2)/σ², where that of Student's law is (ν + 1)/(ν + 3) of it (Louis 1982: what is missing).
With that factor it is the second rival. With u = C⁻¹(z − Bθ̂), v = C⁻¹f freed of B alike, a the size with mean â and
variance s²/(1 + s²S), and D the diagonal of C⁻¹ freed of B, a hypothesis of `fits` says

    E[e²] = σ²(1 − σ²D) + σ⁴((u − â·v)² + v²·s²/(1 + s²S)).
"""

from dataclasses import replace

import numpy as np

from estimator.health.error_laws import FREEDOMS
from estimator.health.fits import PART_SIZES, Fits, Readings, fits
from estimator.health.pooled import Prior
from estimator.health.posterior import Hypotheses, hypotheses_of
from estimator.health.shapes import Shapes
from estimator.session import Array

ROUNDS = 2
"""Rounds of both laws in turn; more are dearer than the forecast may become."""
FELT = 0.01
"""Chance of tails below which normal errors are as good."""


def reweighted(readings: Readings, family: Shapes, prior: Prior, *, is_missing: bool) -> Readings:
    """The readings with the effective standard uncertainties of the sessions, T; ``is_missing``: whether λ is counted
    as missing.
    """
    if prior.tails[1:].sum() < FELT:
        return readings
    worth = readings
    for _ in range(ROUNDS):
        found = fits(worth, family)
        square = _squares(found, worth, hypotheses_of(found, prior))
        kappa = _precision(square / readings.sigma**2, prior.tails, is_missing=is_missing)
        worth = replace(worth, sigma=readings.sigma / np.sqrt(kappa))
    return worth


def _precision(ratio: Array, tails: Array, *, is_missing: bool) -> Array:
    """κ of ρ (n, k), dimensionless."""
    nu = FREEDOMS[1:]
    share = (nu + 1) / (nu + 3) if is_missing else 1.0
    return np.asarray(tails[0] + (tails[1:] * share * (nu + 1) / (nu - 2 + ratio[..., None])).sum(axis=-1))


def _squares(found: Fits, readings: Readings, all_of: Hypotheses) -> Array:
    """(n, k) E[e²], T²."""
    back = np.swapaxes(np.linalg.inv(found.root), -1, -2)
    u, v = (back @ found.z[..., None])[..., 0], back @ found.shapes
    freed = back - (back @ found.frame) @ np.swapaxes(found.frame, -1, -2)
    walk, first, second = _moments(found, all_of)
    away = u**2 * walk[:, None, None]
    away += (-2 * u[..., None] * v * first[..., None, :] + v**2 * second[..., None, :]).sum(axis=-1)
    known = (freed**2).sum(axis=-1) * walk[:, None, None]
    variance = readings.sigma**2
    return np.asarray(variance * (1 - variance * known.sum(axis=0).T) + variance**2 * away.sum(axis=0).T)


def _moments(found: Fits, all_of: Hypotheses) -> tuple[Array, Array, Array]:
    """Chance (Q,) of each strength of the walk; over all hypotheses of a shape chance times â, and times E[a²],
    (Q, k, H) both."""
    q, part, shape = all_of.walk, all_of.part, all_of.shape
    s2 = (PART_SIZES[part] ** 2 * (part > 0))[:, None]
    spread = s2 / (1 + s2 * found.information[q, :, shape])
    size = spread * found.score[q, :, shape]
    first, second = np.zeros((2, *np.swapaxes(found.score, 1, 2).shape))
    np.add.at(first, (q, shape), all_of.weight[:, None] * size)
    np.add.at(second, (q, shape), all_of.weight[:, None] * (size**2 + spread))
    walk = np.bincount(q, weights=all_of.weight, minlength=len(found.walks))
    return walk, np.swapaxes(first, 1, 2), np.swapaxes(second, 1, 2)
