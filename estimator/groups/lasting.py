"""Effects that the sessions of a unit show together, and the probability that the latest of them has them.

Theory
------
An effect that the pool of all sessions shows may have ended before the latest one. Its amplitude from the n others is
a ~ N(â, V), with V = σ² + τ² what is not known of it in one session. The latest session with score U and information F
then says by the factor p(U | a) / p(U | none) whether it has the effect. That n sessions of n had it makes the odds
n + 1 beforehand (Laplace's rule of succession).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from estimator.causes.contract import Cause
from estimator.diagnosis.results import Rival
from estimator.groups.course import answered
from estimator.groups.evidence import log_sum
from estimator.groups.findings import PooledEffect, effect_of, finding_of
from estimator.groups.joint_fit import predictive
from estimator.groups.layout import pool_of
from estimator.groups.priors import UNIT
from estimator.groups.random_effects import mean_of
from estimator.groups.results import GroupFinding
from estimator.groups.statistics import SessionStatistics
from estimator.session import CalibrationSession

SURE = 0.9
"""Probability that the latest session has an effect, from which on it is named there: at strength 3 in each of eleven
sessions one name in twenty is missed, and one in twelve outlasts its effect."""

ENDED = 0.05
"""Probability below which the latest session is said to lack it."""


@dataclass(frozen=True, eq=False)
class Lasting:
    """An effect of a unit's sessions, as the latest of them may have it."""

    finding: GroupFinding
    """The finding over all sessions."""
    others: GroupFinding
    """The finding with the amplitude of the other sessions, without the latest."""
    sessions: int
    """Number of sessions that contribute evidence, the latest among them."""
    began: int
    """Number of sessions before the latest in which it is known to act; 0 where it began with the latest itself."""
    probability: float
    """Probability that the latest session has it."""
    ranking: tuple[Rival, ...]
    """The effect and those that the pool cannot tell from it, likeliest first."""


def lasting(
    records: Sequence[SessionStatistics], catalogue: Sequence[Cause], sessions: Sequence[CalibrationSession]
) -> list[Lasting]:
    """The effects that the sessions of a unit, oldest first, show together and the latest can tell.

    ``sessions``: of the latest records, as many as are at hand. By them every name is held against what no catalogue
    has.
    """
    pool = pool_of(records, UNIT)
    known = {cause.identifier for cause in catalogue}
    barred = frozenset(h.group for h in pool.places if not h.nameless and h.cause not in known)
    answer = answered(pool, records, sessions, barred)
    found = []
    for term in answer.model.named:
        effect = effect_of(answer, term)
        whole = finding_of(answer, effect, [("", None)] * len(effect.rivals))
        found += list(_in_latest(effect, whole))
    return found


def _in_latest(effect: PooledEffect, whole: GroupFinding) -> Iterator[Lasting]:
    """The finding as the latest session may have it; nothing where that session cannot tell."""
    U, F, latest = effect.U, effect.F, len(effect.F) - 1
    seen = (np.diagonal(F, axis1=1, axis2=2).sum(axis=1) > 0) & (np.arange(len(F)) >= effect.term.since)
    others = seen & (np.arange(len(F)) < latest)
    if not seen[latest] or not others.any():
        return
    mean = mean_of(U[others], F[others])
    spread = mean.covariance + mean.spread**2 * np.eye(len(mean.value))
    count = int(others.sum())
    yield Lasting(
        finding=whole,
        others=replace(
            whole,
            amplitude=tuple(mean.value.tolist()),
            sigma=tuple(s if s > 0 else None for s in mean.sigma.tolist()),
            spread=(mean.spread,),
        ),
        sessions=count + 1,
        began=latest - effect.term.since,
        probability=probability(predictive(mean.value, spread, U[latest], F[latest]), count),
        ranking=tuple(_ranking(effect)),
    )


def _ranking(effect: PooledEffect) -> Iterator[Rival]:
    """Shares of all explanations, given that one of them acts."""
    every = effect.weighed.ranked()
    whole = float(log_sum(np.array([value for _, _, value in every])))
    shown = {effect.hypothesis.group, *(n.hypothesis.group for n in effect.rivals)}
    for (w, k), h, value in every:
        if h.group in shown:
            strength = float(np.sqrt(effect.weighed.widths[w].statistic[k]))
            yield Rival(h.cause, (h.sensor,) if h.sensor else (), float(np.exp(value - whole)), strength)


def probability(gained: float, others: int) -> float:
    """Probability that a session has an effect of so many others; ``gained``: ln of the factor by which its readings
    favour it.
    """
    odds = np.log(others + 1.0) + gained
    return float(1 / (1 + np.exp(-np.clip(odds, -50, 50))))
