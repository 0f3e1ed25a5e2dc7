"""The e-value of a group after every session: what a look at each upload would have seen."""

from collections.abc import Sequence

import numpy as np

from estimator.groups.evidence import beginnings, first_seen, log_bayes, log_sum, log_varying
from estimator.groups.layout import pool_in
from estimator.groups.pool import PoolMoments
from estimator.groups.priors import FORMS, SAME, SINCE, UNIT, VARYING
from estimator.groups.scores import batch
from estimator.groups.statistics import SessionStatistics
from estimator.session import Array


def e_process(statistics: Sequence[SessionStatistics], level: str = UNIT) -> Array:
    """(n,) ln of the group's e-value after each of n sessions, oldest first, nothing found before."""
    pool = pool_in(statistics, level, np.ones(len(statistics)))
    moments = pool.given().moments
    scale = scales(statistics, moments)
    named = {w: np.array([not h.nameless for h in table], bool) for w, table in pool.hypotheses.items()}
    looks = [_looks(m, pool.log_prior[w], named[w], scale) for w, m in moments.items()]
    prior = sum(float(np.exp(p[named[w]]).sum()) for w, p in pool.log_prior.items())
    rest = np.full((len(statistics), 1), np.log1p(-prior) if prior < 1 else -np.inf)
    return log_sum(np.concatenate([*looks, rest], axis=1).T)


def scales(statistics: Sequence[SessionStatistics], moments: dict[int, PoolMoments]) -> Array:
    """(n,) at least 1: by how much the sessions so far scatter more than stated, their largest effect taken out."""
    energy = np.cumsum([s.energy.sum() for s in statistics])
    freedom = np.cumsum([s.freedom.sum() for s in statistics])
    largest = np.zeros(len(energy))
    for m in moments.values():
        U, F = m.U.cumsum(axis=0), m.F.cumsum(axis=0)
        n, H, w = U.shape
        statistic, _ = batch(U.reshape(n * H, w), F.reshape(n * H, w, w))
        largest = np.maximum(largest, statistic.reshape(n, H).max(axis=1))
    return np.maximum(1.0, (energy - largest) / freedom)


def _looks(m: PoolMoments, log_prior: Array, named: Array, scale: Array) -> Array:
    """(n, 3 H) ln of what every name of a width in every form adds to the e-value after each session."""
    U, F = (m.U * m.shrink)[:, named], m.F[:, named]
    n, H, w = U.shape
    by = scale[:, None]
    first = first_seen(F)
    seen_U, seen_F = U.cumsum(axis=0) / by[..., None], F.cumsum(axis=0) / by[..., None, None]
    same = log_bayes(seen_U, seen_F, first) + np.log(FORMS[SAME])
    each, freedom = batch(U.reshape(n * H, w), F.reshape(n * H, w, w))
    sums = each.reshape(n, H).cumsum(axis=0) / by, freedom.reshape(n, H).cumsum(axis=0)
    varying = np.array([log_varying(s, q) for s, q in zip(*sums, strict=True)]) + np.log(FORMS[VARYING])
    since = np.zeros((n, H))
    left = np.ones(n)
    parts = []
    for j, k in enumerate(beginnings(n)):
        share = 1 / ((j + 1) * (j + 2))
        value = np.full((n, H), -np.inf)
        after_U, after_F = U[k:].cumsum(axis=0), F[k:].cumsum(axis=0)
        value[k:] = log_bayes(after_U / by[k:, :, None], after_F / by[k:, :, None, None], first_seen(F[k:]))
        parts.append(value + np.log(share))
        left[k:] -= share
    since = log_sum(np.array([*parts, np.log(left)[:, None] * np.ones((1, H))])) + np.log(FORMS[SINCE])
    return np.asarray(np.concatenate([x + log_prior[named] for x in (same, varying, since)], axis=1))
