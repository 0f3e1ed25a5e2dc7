"""How the parameters of a unit type behave, learned from its own histories: empirical Bayes.

Each history of a parameter is of one kind at one strength of its walk (`fits`): nothing, a jump or a late drift at some
time, a drift from the start, aging. Jumps and late drifts come as Poisson processes with a rate per year for each size;
drifts from the start and aging have a chance per parameter. With the marginal likelihoods L_i(q, p) of M histories,

    γ_i(q, p) ∝ ω_q·π_p(span_i)·L_i(q, p)

and the parameters are the mode under conjugate weak priors, by expectation maximisation (Dempster, Laird & Rubin 1977):
ω and the chances with Dirichlet, the rates with gamma priors, each worth a few histories of what inertial units do in
general. So a type of one unit works as well, and a type of many hardly feels them.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from estimator.health.error_laws import FREEDOMS, NORMAL, USUAL
from estimator.health.fits import PART_KINDS, WALKS
from estimator.health.shapes import Kind
from estimator.session import Array

COMES = (PART_KINDS == Kind.JUMP) | (PART_KINDS == Kind.LATE)
"""(P,) bool: parts that happen at some time, with a rate."""
STARTS = (PART_KINDS == Kind.START) | (PART_KINDS == Kind.AGING)
"""(P,) bool: parts that a history has from its start, with a chance."""
WALK = np.array([0.70, 0.12, 0.08, 0.05, 0.03, 0.015, 0.005])
"""(7,) chance of each strength of the walk in units in general: most keep their values within their uncertainty."""
CHANCE = np.array([0.003, 0.003, 0.002] * 2 + [0.006, 0.006, 0.004] + [0.01, 0.01])
"""(P − 1,) per year of jumps and late drifts, by size, and per history of drifts from the start and of aging: one in
sixty parameters a year begins something, one in thirty has from the start."""
HISTORIES = 10.0
"""Histories that the general strength of the walk, and the chances, are worth."""
YEARS = 40.0
"""Years of histories that the general rates are worth."""
ROUNDS = 60
"""Of the expectation maximisation: the slowest moves by less than 1e-3 of itself then."""


@dataclass(frozen=True, eq=False)
class Prior:
    """What is expected of a parameter before its own history is looked at."""

    walk: Array
    """(Q,) chance of each strength."""
    rate: Array
    """(P,) per year, of jumps and late drifts by size; 0 elsewhere."""
    chance: Array
    """(P,) per history, of drifts from the start and of aging; 0 elsewhere."""
    histories: int = 0
    """That it was learned from; 0 for units in general."""
    tails: Array = field(default_factory=NORMAL.copy)
    """(4,) chance of each law of errors."""

    def parts(self, span: Array | float) -> Array:
        """(..., P) chance of each part within histories of (...,) years."""
        span = np.asarray(span, dtype=float)[..., None]
        total = self.rate.sum()
        still = 1 - self.chance.sum()
        come = still * -np.expm1(-total * span) * self.rate / max(total, 1e-300)
        none = still * np.exp(-total * span) * (PART_KINDS == Kind.NONE)
        return np.asarray(come + none + self.chance)

    @property
    def usual_walk(self) -> float:
        """Strength that half of the parameters do not exceed, T a root year: who walks more has moved."""
        above = np.cumsum(self.walk)
        return float(np.interp(0.5, above, WALKS)) if above[0] < 0.5 else 0.0


def general_prior() -> Prior:
    """Of units in general."""
    chance = np.concatenate([[0.0], CHANCE])
    return Prior(WALK / WALK.sum(), np.where(COMES, chance, 0.0), np.where(STARTS, chance, 0.0), tails=USUAL)


@dataclass(frozen=True, eq=False)
class Evidence:
    """What one history of a parameter tells of its type: enough to learn from, without its readings."""

    span: float
    """Years."""
    log_evidence: Array
    """(Q, P) of `Fits.log_evidence`."""
    log_tails: Array = field(default_factory=lambda: np.zeros(len(FREEDOMS)))
    """(4,) of `tails.log_tails`; zero where it tells nothing."""


def learn(histories: Sequence[Evidence]) -> Prior:
    """From all histories of one parameter of a type; of none the general prior."""
    general = general_prior()
    if not histories:
        return general
    span = np.array([h.span for h in histories])
    log = np.stack([h.log_evidence for h in histories])
    likelihood = np.exp(log - log.max(axis=(1, 2), keepdims=True))
    found = general
    for _ in range(ROUNDS):
        found = _improved(found, general, likelihood, span)
    return replace(found, tails=_weighed(general.tails, np.stack([h.log_tails for h in histories])))


def _weighed(usual: Array, logs: Array) -> Array:
    """(4,) chance of each law of errors, from those of M histories (M, 4)."""
    log = np.log(usual) + logs.sum(axis=0)
    weight = np.exp(log - log.max())
    return np.asarray(weight / weight.sum())


def _improved(found: Prior, general: Prior, likelihood: Array, span: Array) -> Prior:
    """One round; likelihood (M, Q, P) and span (M,) years."""
    joint = likelihood * found.walk[:, None] * found.parts(span)[:, None, :]
    joint = joint / joint.sum(axis=(1, 2), keepdims=True)
    parts, m = joint.sum(axis=(0, 1)), len(span)
    return Prior(
        walk=(joint.sum(axis=(0, 2)) + HISTORIES * general.walk) / (m + HISTORIES),
        rate=np.where(COMES, (parts + YEARS * general.rate) / (span.sum() + YEARS), 0.0),
        chance=np.where(STARTS, (parts + HISTORIES * general.chance) / (m + HISTORIES), 0.0),
        histories=m,
    )
