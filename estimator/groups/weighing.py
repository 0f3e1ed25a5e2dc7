"""Every hypothesis of a pool weighed: how likely what is seen is with it, in each form, against nothing."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from estimator.groups.evidence import (
    FORMS,
    SAME,
    SINCE,
    VARYING,
    beginnings,
    first_seen,
    log_bayes,
    log_since,
    log_sum,
    log_varying,
)
from estimator.groups.layout import GroupHypothesis
from estimator.groups.pool import Place, Pool, PoolMoments
from estimator.groups.scores import LEFT, batch
from estimator.session import Array


@dataclass(frozen=True, eq=False)
class WeighedGroup:
    """H hypotheses of one width, weighed."""

    statistic: Array
    """(H,) χ² of the pool."""
    freedom: Array
    """(H,) degrees of freedom of ``statistic``."""
    forms: Array
    """(3, H) ln Bayes factor, the form's prior share included."""
    since: Array
    """(H,) int: the session at which an effect that began is most likely to have begun."""
    log_prior: Array
    """(H,)"""

    @property
    def log_evidence(self) -> Array:
        """(H,) ln of what each adds to the e-value of the group."""
        return np.asarray(self.log_prior + log_sum(self.forms))


@dataclass(frozen=True, eq=False)
class Scale:
    """All hypotheses of a pool, weighed, by width."""

    pool: Pool
    weighed: dict[int, WeighedGroup]

    @property
    def log_e_value(self) -> float:
        """ln of the e-value of the group: against nothing at all beside what was found."""
        evidences = [log_sum(w.log_evidence) for w in self.weighed.values() if np.isfinite(w.log_evidence).any()]
        rest = np.log1p(-min(self.prior, 1.0)) if self.prior < 1 else -np.inf
        return float(log_sum(np.array([*evidences, rest]))) if evidences else 0.0

    @property
    def prior(self) -> float:
        """Share of the prior that the hypotheses of the pool have; what is left is of those that may come."""
        return float(sum(np.exp(w.log_prior).sum() for w in self.weighed.values()))

    def ranked(self) -> Iterator[tuple[Place, GroupHypothesis, float]]:
        """The best shape of every named hypothesis with the ln evidence of all its shapes, strongest first."""
        groups: dict[tuple[str, ...], list[tuple[float, Place, GroupHypothesis]]] = {}
        for w, weighed in self.weighed.items():
            for k, value in enumerate(weighed.log_evidence):
                h = self.pool.layout.hypotheses[w][k]
                if np.isfinite(value):
                    groups.setdefault(h.group, []).append((float(value), (w, k), h))
        best = [(max(g, key=lambda x: x[0]), float(np.logaddexp.reduce([x[0] for x in g]))) for g in groups.values()]
        for (_, place, h), value in sorted(best, key=lambda pair: -round(pair[1], 9)):
            yield place, h, value

    def form(self, place: Place) -> int:
        """The likeliest form of a hypothesis."""
        w, k = place
        return int(np.argmax(self.weighed[w].forms[:, k]))


def weigh(pool: Pool, barred: frozenset[tuple[str, ...]] = frozenset()) -> Scale:
    """Weigh every hypothesis; ``barred`` groups have no part."""
    return Scale(pool, {w: _weighed(pool, w, m, barred) for w, m in pool.moments.items()})


def _weighed(pool: Pool, w: int, m: PoolMoments, barred: frozenset[tuple[str, ...]]) -> WeighedGroup:
    U, F = m.pooled
    E, alone = m.evidence.sum(axis=0), m.F.sum(axis=0)
    size = np.diagonal(alone, axis1=1, axis2=2)
    gone = np.asarray((np.diagonal(F, axis1=1, axis2=2) <= LEFT * size).all(axis=1))
    U, E = np.where(gone[:, None], 0.0, U), np.where(gone[:, None], 0.0, E)
    F = np.where(gone[:, None, None], 0.0, F)
    statistic, freedom = batch(U, F)
    named = np.array([not h.nameless for h in pool.layout.hypotheses[w]])
    forms, since = weighed_forms(m.evidence, m.F, E, F, named)
    forms[:, gone] = np.log(FORMS)[:, None]
    prior = pool.layout.log_prior[w].copy()
    prior[[h.group in barred for h in pool.layout.hypotheses[w]]] = -np.inf
    return WeighedGroup(statistic, freedom, forms, since, prior)


def weighed_forms(u: Array, f: Array, U: Array, F: Array, named: Array) -> tuple[Array, Array]:
    """(3, H) ln Bayes factor in each form, its prior share included, and (H,) the likeliest session of a beginning.

    ``u`` (n, H, w) scores and ``f`` (n, H, w, w) information of the sessions; ``U`` (H, w) and ``F`` (H, w, w)
    of the pool; ``named`` (H,) bool: what else than always the same may be asked of.
    """
    forms = np.full((3, len(U)), -np.inf)
    since = np.zeros(len(U), dtype=int)
    forms[SAME] = log_bayes(U, F, first_seen(f)) + np.log(FORMS[SAME])
    if named.any():
        forms[VARYING, named] = log_varying(*_each_session(u[:, named], f[:, named])) + np.log(FORMS[VARYING])
        began = log_since(u[:, named], f[:, named])
        if len(began):
            forms[SINCE, named] = log_sum(began) + np.log(FORMS[SINCE])
            since[named] = np.array(beginnings(len(f)))[began.argmax(axis=0)]
    return forms, since


def _each_session(u: Array, f: Array) -> tuple[Array, Array]:
    """(H,) sums over sessions of χ² and of their degrees of freedom."""
    n, H, w = u.shape
    statistic, freedom = batch(u.reshape(n * H, w), f.reshape(n * H, w, w))
    return statistic.reshape(n, H).sum(axis=0), freedom.reshape(n, H).sum(axis=0)
