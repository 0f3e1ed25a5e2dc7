"""The usual behaviour of a unit type's parameters, learned from its own histories: empirical Bayes.

Each history of a parameter is of one kind at one strength of its walk (`fits`): nothing, a jump or a late drift at some
time, a drift from the start, aging, temperature. Jumps and late drifts come as Poisson processes with a rate per year
for each size; the others have a chance per parameter. With the marginal likelihoods L_i(q, p) of M histories,

    γ_i(q, p) ∝ ω_q·π_p(span_i)·L_i(q, p),    ω of those that change and of the others apart,

and the parameters are the mode under conjugate weak priors, by expectation maximisation (Dempster, Laird & Rubin 1977):
ω and the chances with Dirichlet, the rates with gamma priors, each worth a few histories of what inertial units do in
general. So a type of one unit works as well, and a type of many hardly feels them.

Parameters differ in how readily something begins in them: the rate of one is Λ·Z with Z of a gamma law of mean 1 and
shape κ (frailty; Vaupel, Manton & Stallard 1979). Quiet for t years are (1 + Λt/κ)^{−κ} of them, and the rate of those
has fallen to Λ·κ/(κ + Λt): who was quiet for long is one of the good ones. Histories have one change each, so of a
parameter that has changed they do not tell how soon it changes again: at the rates of units in general, or at those of
the type where they are lower.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from estimator.health.error_laws import FREEDOMS, NORMAL, USUAL
from estimator.health.fits import PART_KINDS, WALKS
from estimator.health.shapes import STILL, Kind
from estimator.session import Array

COMES = (PART_KINDS == Kind.JUMP) | (PART_KINDS == Kind.LATE)
"""(P,) bool: parts that happen at some time, with a rate."""
STARTS = np.isin(PART_KINDS, (Kind.START, Kind.AGING, Kind.SETTLING, Kind.WARMTH))
"""(P,) bool: parts that a history has from its start, with a chance."""
QUIET = np.isin(PART_KINDS, STILL)
"""(P,) bool: parts in which nothing has begun."""
WALK = np.array([0.70, 0.12, 0.08, 0.05, 0.03, 0.015, 0.005])
"""(7,) chance of each strength of the walk in units in general: most keep their values within their uncertainty."""
CHANCE = np.array([0.003, 0.003, 0.002] * 2 + [0.006, 0.006, 0.004] + [0.005] * 7)
"""(P − 1,) per year of jumps and late drifts, by size, and per history of drifts from the start and of aging: one in
sixty parameters a year begins something, one in thirty has from the start."""
HISTORIES = 10.0
"""Histories that the general strength of the walk, and the chances, are worth."""
ENDS = 10.0
"""Agings that it is worth that as many go on as come to an end: a short history hardly distinguishes them, and a
few that favour one by a little would else settle it for all."""
YEARS = 20.0
"""Years of histories that the general rates are worth: as many histories, of two years each."""
FRAILTY = 0.5
"""κ: rates differ by more than their mean, as those of weak and sound parts do. The histories of one type, all about as
long, hardly tell it."""
ROUNDS = 60
"""Rounds of expectation maximisation, after which the slowest number moves by less than 1e-3 of itself."""


@dataclass(frozen=True, eq=False)
class Prior:
    """The expected behaviour of a parameter, before its own history is looked at."""

    walk: Array
    """(Q,) chance of each walk strength, for a parameter in which nothing else happens."""
    moving: Array
    """(Q,) chance of each walk strength, for a parameter that changes: one that wanders need not drift."""
    rate: Array
    """(P,) rate per year of jumps and late drifts, by size; 0 elsewhere."""
    chance: Array
    """(P,) chance per history of drifts from the start and of aging; 0 elsewhere."""
    histories: int = 0
    """Number of histories it was learned from; 0 for units in general."""
    tails: Array = field(default_factory=NORMAL.copy)
    """(4,) chance of each law of errors."""

    def parts(self, span: Array | float) -> Array:
        """(..., P) chance of each part within histories of (...,) years."""
        span = np.asarray(span, dtype=float)[..., None]
        total = self.rate.sum()
        still = 1 - self.chance.sum()
        quiet = (1 + total * span / FRAILTY) ** -FRAILTY
        come = still * (1 - quiet) * self.rate / max(total, 1e-300)
        none = still * quiet * (PART_KINDS == Kind.NONE)
        return np.asarray(come + none + self.chance)

    def joint(self, span: Array | float) -> Array:
        """(..., Q, P) chance of each part at each strength of the walk within histories of (...,) years."""
        strength = np.where(QUIET, self.walk[:, None], self.moving[:, None])
        return np.asarray(strength * self.parts(span)[..., None, :])

    @property
    def again(self) -> Array:
        """(P,) rates per year of the next change of one that has changed; 0 elsewhere."""
        return np.minimum(self.rate, general_prior().rate)

    def remaining_rate(self, span: float, ahead: Array) -> Array:
        """(h,) mean rate within years ahead (h,) of one that was quiet for a span, years; by the rate of a new one."""
        ahead = np.maximum(ahead, 1e-6)
        return np.asarray(self._fall * np.log1p(ahead / (self._fall + span)) / ahead)

    def comes(self, span: float, expected: Array) -> Array:
        """(m,) years ahead by which as many events are expected as within (m,) years of a new one."""
        return np.asarray((self._fall + span) * np.expm1(expected / self._fall))

    @property
    def _fall(self) -> float:
        """κ/Λ, the years of quiet in which the rate of a new one falls to a half."""
        return FRAILTY / max(float(self.rate.sum()), 1e-12)

    @property
    def usual_walk(self) -> float:
        """Strength that half of the parameters do not exceed, T a root year: who walks more has moved."""
        above = np.cumsum(self.walk)
        return float(np.interp(0.5, above, WALKS)) if above[0] < 0.5 else 0.0


def general_prior() -> Prior:
    """The prior for units in general."""
    chance = np.concatenate([[0.0], CHANCE])
    walk = WALK / WALK.sum()
    return Prior(walk, walk, np.where(COMES, chance, 0.0), np.where(STARTS, chance, 0.0), tails=USUAL)


@dataclass(frozen=True, eq=False)
class Evidence:
    """The contribution of one parameter history to its type: enough to learn from, without the readings."""

    span: float
    """Years."""
    log_evidence: Array
    """(Q, P) log evidence by `Fits.log_evidence`."""
    log_tails: Array = field(default_factory=lambda: np.zeros(len(FREEDOMS)))
    """(4,) log likelihoods by `tails.log_tails`; zero where the history contributes nothing."""


def learn(histories: Sequence[Evidence]) -> Prior:
    """Learns the prior from all histories of one parameter of a type; the general prior where there are none."""
    general = general_prior()
    if not histories:
        return general
    span = np.array([h.span for h in histories])
    log = np.stack([h.log_evidence for h in histories])
    likelihood = np.exp(log - log.max(axis=(1, 2), keepdims=True))
    prior = general
    for _ in range(ROUNDS):
        prior = _improved(prior, general, likelihood, span)
    return replace(prior, tails=_posterior_chances(general.tails, np.stack([h.log_tails for h in histories])))


def _posterior_chances(usual: Array, logs: Array) -> Array:
    """(4,) chance of each law of errors, from those of M histories (M, 4)."""
    log = np.log(usual) + logs.sum(axis=0)
    weight = np.exp(log - log.max())
    return np.asarray(weight / weight.sum())


def _improved(prior: Prior, general: Prior, likelihood: Array, span: Array) -> Prior:
    """One round; likelihood (M, Q, P) and span (M,) years."""
    joint = likelihood * prior.joint(span)
    joint = joint / joint.sum(axis=(1, 2), keepdims=True)
    parts, m = joint.sum(axis=(0, 1)), len(span)
    walk, moving = (joint[..., is_quiet].sum(axis=(0, 2)) + HISTORIES * general.walk for is_quiet in (QUIET, ~QUIET))
    return Prior(
        walk=walk / walk.sum(),
        moving=moving / moving.sum(),
        rate=np.where(COMES, (parts + YEARS * general.rate) / (_exposed(prior, joint, span) + YEARS), 0.0),
        chance=_ends_shared(np.where(STARTS, (parts + HISTORIES * general.chance) / (m + HISTORIES), 0.0), parts),
        histories=m,
    )


def _ends_shared(chance: Array, parts: Array) -> Array:
    """(P,) chances per history, in which aging that goes on and aging that ends are as common as (P,) counted histories
    and the prior have it."""
    kinds = [PART_KINDS == Kind.AGING, PART_KINDS == Kind.SETTLING]
    expected = np.array([parts[members].sum() for members in kinds]) + ENDS / 2
    total = sum(chance[members].sum() for members in kinds)
    for members, share in zip(kinds, expected / expected.sum(), strict=True):
        chance[members] *= share * total / chance[members].sum()
    return chance


def _exposed(prior: Prior, joint: Array, span: Array) -> float:
    """Years at the rate of a new one: of the quiet by what is left of their frailty, of those to which something came
    until then; those that do something from their start tell nothing of what comes."""
    came, still = (joint[:, :, parts].sum(axis=(1, 2)) for parts in (COMES, PART_KINDS == Kind.NONE))
    total, half = float(prior.rate.sum()), span / 2
    quiet = span * FRAILTY / (FRAILTY + total * span)
    struck = half * (1 + FRAILTY) / (FRAILTY + total * half)
    return float((still * quiet + came * struck).sum())
