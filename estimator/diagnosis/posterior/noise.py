"""The noise that a session's terms are weighed in: as stated, off by a factor, not stated at all, or with tails.

Each is a hypothesis with its own residuals and its own search. They are compared by the restricted likelihood of the
readings in that noise (`residuals.likelihood`), the evidence of the terms found there, and prior odds; a factor that is
not known is integrated out. Tails are Student's t with ν degrees of
freedom, as normal noise of the variances at which both laws pull a reading alike (Lange, Little and Taylor 1989); what
the laws differ by at the residuals found is added (Laplace's method, MacKay 2003, 27): the normal law has the same
determinant.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import gammaln

from estimator.calibration.noise import with_the_others
from estimator.diagnosis.posterior.explained import NoiseClaim
from estimator.diagnosis.posterior.members import log_sets
from estimator.diagnosis.posterior.priors import MISSTATED, TAILS
from estimator.diagnosis.posterior.term import NOISE, Term
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.likelihood import log_likelihood_ratio
from estimator.diagnosis.residuals.refitted import refitted
from estimator.diagnosis.residuals.remaining import left_by, remaining_of_sensors
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.session import Array

ROUNDS = 8
"""Steps of the variances: each brings them half nearer at least."""

STANDS = 0.01
"""Relative change of a variance at which it stands."""

FEWEST = 6.0
"""Degrees of freedom of residuals, of a kind or of one sensor, from which on they tell a scale."""

ALONE = 0.5
"""Degrees of freedom of one sensor's residuals below which they tell nothing of its noise: what acts took them all."""

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
        energy, left = remaining_of_sensors(WhitenedResiduals.of(replace(baseline, variance=variance)), named)
        value = np.median(variance, axis=0)
        expected = typical_of(baseline, value * energy / np.maximum(left, 1.0)) / value
        energy, freedom = with_the_others(energy, left, np.where(baseline.unstated, expected, np.nan))
        estimable = baseline.unstated & (left >= ALONE)
        ratio = np.where(estimable, energy / np.maximum(freedom, 1.0), 1.0)
        variance = variance * ratio
        if np.abs(np.log(ratio)).max() < STANDS:
            break
    return refitted(replace(baseline, variance=variance))


def of_noisy_sensors(baseline: Baseline, terms: Sequence[Term]) -> Baseline | None:
    """The baseline with the noise of sensors that are noisier than stated as it is, by their own readings, and no less
    than stated; None where there are none."""
    noisy = [t.sensors[0] for t in terms if t.name == NOISE and not baseline.unstated[t.sensors[0]]]
    if not noisy:
        return None
    own = baseline.unstated.copy()
    own[noisy] = True
    found = beside(replace(baseline, unstated=own), columns_of(baseline, terms))
    least = np.where(baseline.unstated, 0.0, baseline.variance)
    return refitted(replace(found, variance=np.maximum(found.variance, least)))


@dataclass(frozen=True, eq=False)
class OtherNoise:
    """Another noise of a session."""

    baseline: Baseline
    log_prior: float
    """ln prior odds against what is stated, and whatever the likelihood of normal noise does not hold."""
    claims: tuple[NoiseClaim, ...] = ()
    tails: bool = False


@dataclass(frozen=True, eq=False)
class OffTogether:
    """Sensors of a kind whose stated noise is off by one factor."""

    kind: str
    sensors: Array
    """(m,) bool."""
    factor: float
    """Variance over the stated one."""
    freedom: float
    log_prior: float
    """ln prior odds of this set and, by Laplace's method, of a factor as near."""


def off_by_a_factor(baseline: Baseline, terms: Sequence[Term]) -> OtherNoise | None:
    """The stated noise of a kind of sensor, or of some of them, off by a factor, as what terms leave shows; None where
    it is as stated.

    Step by step: a sensor that is believed too much pulls what all share of a row to its own readings.
    """
    named, kinds = columns_of(baseline, unlike_noise(baseline, terms)), np.array(baseline.setting.kinds)
    variance, off = baseline.variance, list[OffTogether]()
    for _ in range(ROUNDS):
        energy, freedom = remaining_of_sensors(WhitenedResiduals.of(replace(baseline, variance=variance)), named)
        energy = energy * np.median(variance / baseline.variance, axis=0)
        stated = [kind for kind in dict.fromkeys(kinds.tolist()) if not baseline.unstated[kinds == kind].any()]
        each = [likeliest_set(kind, kinds == kind, energy, freedom) for kind in stated]
        off, before = [one for one in each if one is not None], variance
        variance = baseline.variance.copy()
        for one in off:
            variance[:, one.sensors] *= one.factor
        if np.abs(np.log(variance / before)).max() < STANDS:
            break
    if not off:
        return None
    claims = [NoiseClaim(one.kind, tuple(np.flatnonzero(one.sensors).tolist()), one.factor, one.freedom) for one in off]
    prior = sum(one.log_prior for one in off)
    return OtherNoise(refitted(replace(baseline, variance=variance)), prior, tuple(claims))


def likeliest_set(kind: str, own: Array, energy: Array, freedom: Array) -> OffTogether | None:
    """The likeliest set of sensors of a kind, two at least, whose noise is off by one factor; None where that of all is
    as stated.

    ``own`` (m,) those of the kind; ``energy`` (m,) in stated variances and ``freedom`` (m,) of their residuals. What
    most of them show holds for all: one that scatters otherwise has an effect, or noise, of its own. Half of the prior
    is on all of them, half on fewer as `log_sets` has it.
    """
    order = sorted(np.flatnonzero(own).tolist(), key=lambda i: energy[i] / max(freedom[i], LEAST_FREE))
    m, best, found = len(order), 0.0, None
    for some in (end for k in range(2, m + 1) for end in (order[:k], order[-k:])):
        nu, most = float(freedom[some].sum()), 2 * len(some) > m
        if nu < FEWEST:
            continue
        E = max(float(energy[some].sum()), FAINTEST**2 * nu)
        prior = float(np.log(MISSTATED / 2) + (0.0 if most else log_sets(m)[len(some) - 1]) - 0.5 * np.log(nu / 2))
        value = 0.5 * (E - nu - nu * np.log(E / nu)) + prior
        if value > best:
            sensors = own if most else np.isin(np.arange(len(own)), some)
            best, found = value, OffTogether(kind, sensors, E / nu, nu, prior)
    return found


def with_tails(baseline: Baseline, terms: Sequence[Term]) -> OtherNoise | None:
    """The noise with the likeliest tails, as what terms leave shows, but for those of single readings; None where it is
    normal."""
    named = columns_of(baseline, [t for t in unlike_noise(baseline, terms) if np.count_nonzero(t.columns) > 1])
    normal, best, found = Remaining.of(baseline, named), 0.0, None
    for nu in FREEDOMS:
        prior = float(np.log(TAILS / len(FREEDOMS)))
        scale, tailed = np.full(len(baseline.unstated), np.sqrt((nu - 2) / nu)), normal
        for _ in range(ROUNDS):
            r = tailed.z * np.sqrt(tailed.variance / baseline.variance)
            weight = (nu + 1) / (nu + (r / scale) ** 2)
            free = tailed.freedom.sum(axis=0)
            estimate = np.sqrt((weight * r**2).sum(axis=0) / np.maximum(free, FEWEST))
            scale = np.where(baseline.unstated & (free >= FEWEST), estimate, scale)
            scale = np.maximum(scale, FAINTEST)
            before, variance = tailed.variance, baseline.variance * scale**2 / weight
            tailed = Remaining.of(replace(baseline, variance=variance), named)
            if np.abs(np.log(variance / before)).max() < STANDS:
                break
        sigma = np.sqrt(tailed.variance / baseline.variance)
        r = tailed.z * sigma
        difference = float((log_t(r, nu, scale) - log_normal(r, sigma)).sum())
        gained = tailed.log_likelihood_over(normal) + difference + prior
        if gained > best:
            noise = refitted(replace(baseline, variance=tailed.variance))
            best, found = gained, OtherNoise(noise, prior + difference, tails=True)
    return found


@dataclass(frozen=True, eq=False)
class Remaining:
    """The part of a session's readings that named columns leave in one noise. R rows, m sensors."""

    residuals: WhitenedResiduals
    z: Array
    """(R, m) standard errors."""
    freedom: Array
    """(R, m) degrees of freedom of each."""

    @classmethod
    def of(cls, baseline: Baseline, named: Array | None) -> "Remaining":
        """What columns ``named`` (R, m, q), any unit, leave; all of it where None."""
        residuals = WhitenedResiduals.of(baseline)
        z, freedom = (x[: baseline.residual.size].reshape(baseline.residual.shape) for x in left_by(residuals, named))
        return cls(residuals, z, freedom)

    @property
    def variance(self) -> Array:
        """(R, m) of the noise, (m/s²)² ((rad/s)²)."""
        return self.residuals.baseline.variance

    @property
    def explained(self) -> float:
        """χ² that the columns take."""
        return float(self.residuals.z @ self.residuals.z - (self.z**2).sum())

    def log_likelihood_over(self, other: "Remaining") -> float:
        """ln of the restricted likelihood of the readings beside the columns, over that in another noise."""
        gained = 0.5 * (self.explained - other.explained)
        return log_likelihood_ratio(self.residuals, other.residuals) + gained


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
