"""The noise that a session's terms are weighed in: as stated, off by a factor, not stated at all, or with tails.

Each is a hypothesis with its own residuals and its own search. They are compared by the restricted likelihood of the
readings in that noise (`residuals.likelihood`), the evidence of the terms found there, and prior odds; a factor that is
not known is integrated out. Tails are Student's t with ν degrees of
freedom, as normal noise of the variances at which both laws pull a reading alike (Lange, Little and Taylor 1989); what
the laws differ by at the residuals found is added (Laplace's method, MacKay 2003, 27).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import gammaln

from estimator.calibration.noise import with_the_others
from estimator.diagnosis.posterior.explained import NoiseClaim
from estimator.diagnosis.posterior.priors import MISSTATED, TAILS
from estimator.diagnosis.posterior.term import NOISE, Term
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.refitted import refitted
from estimator.diagnosis.residuals.remaining import left_by, remaining_of_sensors
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.session import Array

ROUNDS = 8
"""Steps of the variances: each brings them half nearer at least."""

STANDS = 0.01
"""Relative change of a variance at which it stands."""

FEWEST = 6.0
"""Degrees of freedom of a kind's residuals from which on they tell a scale."""

FREEDOMS = (3.0, 5.0, 8.0)
"""ν of tails: below three errors have hardly a variance, and far beyond eight they are as good as normal."""


def columns_of(baseline: Baseline, terms: Sequence[Term]) -> Array | None:
    """(R, m, q) m/s² (rad/s): everything that acts but noise larger than stated; None where nothing does."""
    R, m = baseline.residual.shape
    each = [t.columns[: R * m].reshape(R, m, -1) for t in terms if t.name != NOISE]
    return np.concatenate(each, axis=-1) if each else None


def unlike_noise(baseline: Baseline, terms: Sequence[Term]) -> list[Term]:
    """The terms that noise of another law cannot be taken for: those of fewer columns a sensor than there are rows."""
    rows = len(baseline.variance)
    return [t for t in terms if t.columns.shape[1] < rows * max(len(t.sensors), 1)]


def of_quiet_sensors(baseline: Baseline) -> Baseline:
    """The baseline in whose unstated noise no effect of a few sensors hides: none is noisier than usual of its kind."""
    if not baseline.unstated.any():
        return baseline
    usual = typical_of(baseline, np.median(baseline.variance, axis=0))
    variance = np.where(baseline.unstated, np.minimum(baseline.variance, usual), baseline.variance)
    return refitted(replace(baseline, variance=variance))


def typical_of(baseline: Baseline, value: Array) -> Array:
    """(m,) the median of the variances (m,) of unstated sensors of each one's kind, in shares of the applied vector."""
    setting, usual = baseline.setting, value.copy()
    norm = np.broadcast_to(setting.norm, value.shape) ** 2
    kinds = np.array(setting.kinds)
    for kind in set(setting.kinds):
        of_kind = (kinds == kind) & baseline.unstated
        if of_kind.any():
            usual[of_kind] = np.median(value[of_kind] / norm[of_kind]) * norm[of_kind]
    return usual


def beside(baseline: Baseline, named: Array | None) -> Baseline:
    """The baseline with the noise that columns ``named`` (R, m, q) leave of the sensors whose noise is not stated: each
    its own, as the others of its kind suggest it."""
    variance = baseline.variance
    for _ in range(ROUNDS):
        energy, freedom = remaining_of_sensors(WhitenedResiduals.of(replace(baseline, variance=variance)), named)
        value = np.median(variance, axis=0)
        expected = typical_of(baseline, value * energy / np.maximum(freedom, 1.0)) / value
        energy, freedom = with_the_others(energy, freedom, np.where(baseline.unstated, expected, np.nan))
        ratio = np.where(baseline.unstated, energy / np.maximum(freedom, 1.0), 1.0)
        variance = variance * ratio
        if np.abs(np.log(ratio)).max() < STANDS:
            break
    return refitted(replace(baseline, variance=variance))


def of_noisy_sensors(baseline: Baseline, terms: Sequence[Term]) -> Baseline | None:
    """The baseline with the noise of sensors that are noisier than stated as it is, by their own readings; None where
    there are none."""
    noisy = [t.sensors[0] for t in terms if t.name == NOISE and not baseline.unstated[t.sensors[0]]]
    if not noisy:
        return None
    own = baseline.unstated.copy()
    own[noisy] = True
    return beside(replace(baseline, unstated=own), columns_of(baseline, terms))


@dataclass(frozen=True, eq=False)
class OtherNoise:
    """Another noise of a session."""

    baseline: Baseline
    log_prior: float
    """ln prior odds against what is stated, and whatever the likelihood of normal noise does not hold."""
    claims: tuple[NoiseClaim, ...] = ()
    tails: bool = False


def off_by_a_factor(baseline: Baseline, terms: Sequence[Term], noisy: Sequence[int]) -> OtherNoise | None:
    """The stated noise of whole kinds off by a factor each, as what terms leave shows; None where it is as stated.

    ``noisy``: sensors that were found noisier than stated; where they are few of a kind the others tell its factor.
    """
    named, kinds = columns_of(baseline, unlike_noise(baseline, terms)), np.array(baseline.setting.kinds)
    energy, freedom = remaining_of_sensors(WhitenedResiduals.of(baseline), named)
    variance, unstated = baseline.variance.copy(), baseline.unstated
    known = ~np.isin(np.arange(len(kinds)), noisy)
    off = []
    for kind in dict.fromkeys(baseline.setting.kinds):
        own = kinds == kind
        asked = own & known if 2 * (own & known).sum() > own.sum() else own
        E, nu = float(energy[asked].sum()), float(freedom[asked].sum())
        if own.sum() < 2 or unstated[own].any() or nu < FEWEST:
            continue
        E = max(E, FAINTEST**2 * nu)
        if 0.5 * (E - nu - nu * np.log(E / nu)) - 0.5 * np.log(nu / 2) + np.log(MISSTATED) > 0:
            off.append(kind)
    if not off:
        return None
    groups = [kinds == kind for kind in off]
    for _ in range(ROUNDS):
        energy, freedom = remaining_of_sensors(WhitenedResiduals.of(replace(baseline, variance=variance)), named)
        ratio = [max(energy[g].sum() / max(freedom[g].sum(), 1.0), FAINTEST**2) for g in groups]
        for group, factor in zip(groups, ratio, strict=True):
            variance[:, group] *= factor
        if np.abs(np.log(ratio)).max() < STANDS:
            break
    prior, claims = 0.0, []
    for kind, group in zip(off, groups, strict=True):
        nu = float(freedom[group].sum())
        prior += float(np.log(MISSTATED) - 0.5 * np.log(nu / 2))
        factor = float(np.median(variance[:, group] / baseline.variance[:, group]))
        claims.append(NoiseClaim(kind, tuple(np.flatnonzero(group).tolist()), factor, nu))
    return OtherNoise(refitted(replace(baseline, variance=variance)), prior, tuple(claims))


def with_tails(baseline: Baseline, terms: Sequence[Term]) -> OtherNoise | None:
    """The noise with the likeliest tails, as what terms leave shows, but for those of single readings; None where it is
    normal."""
    named = columns_of(baseline, [t for t in unlike_noise(baseline, terms) if np.count_nonzero(t.columns) > 1])
    best, found = 0.0, None
    for nu in FREEDOMS:
        prior = float(np.log(TAILS / len(FREEDOMS)))
        scale, variance = np.full(len(baseline.unstated), np.sqrt((nu - 2) / nu)), baseline.variance
        for _ in range(ROUNDS):
            r, freedom = readings_left(replace(baseline, variance=variance), baseline.variance, named)
            weight = (nu + 1) / (nu + (r / scale) ** 2)
            if baseline.unstated.any():
                scale = np.sqrt((freedom * weight * r**2).sum(axis=0) / np.maximum(freedom.sum(axis=0), 1e-300))
            scale = np.maximum(scale, FAINTEST)
            variance = baseline.variance * scale**2 / weight
        law = log_t(r, nu, scale)
        gained = float((freedom * (law - log_normal(r, np.ones_like(scale)))).sum()) + prior
        if gained > best:
            difference = float((freedom * (law - log_normal(r, scale / np.sqrt(weight)))).sum())
            tailed = refitted(replace(baseline, variance=variance))
            best, found = gained, OtherNoise(tailed, prior + difference, tails=True)
    return found


def readings_left(baseline: Baseline, stated: Array, named: Array | None) -> tuple[Array, Array]:
    """(R, m) what columns ``named`` leave of each reading, in the sigmas of the ``stated`` variance (R, m), and (R, m)
    its degrees of freedom."""
    z, freedom = left_by(WhitenedResiduals.of(baseline), named)
    z, freedom = (x[: stated.size].reshape(stated.shape) for x in (z, freedom))
    freedom = np.where(freedom > LEAST_FREE, freedom, 0.0)
    return z / np.sqrt(np.maximum(freedom, LEAST_FREE)) * np.sqrt(baseline.variance / stated), freedom


FAINTEST = 1e-4
"""Standard errors below which no scatter is told apart: readings simulated without noise leave rounding."""

LEAST_FREE = 0.2
"""Degrees of freedom of a reading below which its residual tells nothing."""


def log_t(r: Array, nu: float, scale: Array) -> Array:
    """ln density of Student's t with ν degrees of freedom at r (R, m), of ``scale`` (m,)."""
    constant = gammaln((nu + 1) / 2) - gammaln(nu / 2) - 0.5 * np.log(nu * np.pi) - np.log(scale)
    return np.asarray(constant - (nu + 1) / 2 * np.log1p((r / scale) ** 2 / nu))


def log_normal(r: Array, sigma: Array) -> Array:
    """ln density of normal noise of ``sigma`` at r (R, m)."""
    return np.asarray(-0.5 * (r / sigma) ** 2 - np.log(sigma) - 0.5 * np.log(2 * np.pi))
