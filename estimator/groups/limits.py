"""Detection limits of a pool at 95 % power, beside those of its latest session.

The e-value of the group reaches 1/α when ½·T·g − ½·ln(1 + κ²·r) + ln(prior) does, with r the pool's information in
units of the first session's and g = κ²·r/(1 + κ²·r). A candidate of strength s has T ≥ threshold with 95 % power where
s exceeds the root of the threshold by the normal quantile of 95 %.
"""

import numpy as np

from estimator.causes.catalogue import cause
from estimator.causes.contract import Signature
from estimator.diagnosis.results import Limit
from estimator.groups.candidates import lasting_causes
from estimator.groups.evidence import first_seen
from estimator.groups.layout import EVERY
from estimator.groups.pool import GroupHypothesis, Pool, PoolMoments
from estimator.groups.priors import ENOUGH, FORMS, SAME, STAND, STRENGTHS
from estimator.groups.results import PoolLimit
from estimator.session import Array

POWER = 1.6449
"""Quantile of 95 % of the normal distribution: the usual power of a detection limit (ISO 11843)."""


def limits(pool: Pool, level: str) -> tuple[PoolLimit, ...]:
    """One limit a lasting cause, at the place of the group where it is seen worst."""
    moments = pool.given().moments
    return tuple(limit_of(pool, moments, c, level) for c in lasting_causes())


def limit_of(pool: Pool, moments: dict[int, PoolMoments], known: Signature, level: str) -> PoolLimit:
    """The limit of one cause."""
    worst: list[Array] = []
    latest: list[Array] = []
    for w, table in pool.hypotheses.items():
        m = moments[w]
        first, total = first_seen(m.F), m.F.sum(axis=0)
        for k, h in enumerate(table):
            if h.cause != known.identifier or not _asked(h, level):
                continue
            information = m.F[:, k]
            seen = np.flatnonzero(np.diagonal(information, axis1=1, axis2=2).sum(axis=1))
            if len(seen):
                prior = float(pool.log_prior[w][k])
                worst.append(_smallest(total[k], first[k], prior))
                latest.append(_smallest(information[seen[-1]], first[k], prior))
    return PoolLimit(**vars(_limit(known, worst)), one_session=_limit(known, latest).amplitude)


def _asked(h: GroupHypothesis, level: str) -> bool:
    """Whether a hypothesis belongs to the group's level: its own sensors, or the stand's causes."""
    return h.level == STAND if not h.sensor else h.level == level and h.sensor != EVERY


def _smallest(total: Array, first: Array, log_prior: float) -> Array:
    """(w,) SI amplitude, element by element, found with 95 % power; infinite where it is not seen."""
    size, start = np.diagonal(total), np.diagonal(first)
    with np.errstate(divide="ignore"):
        ratio = np.where(start > 0, size / np.where(start > 0, start, 1.0), 0.0)
        need = np.stack([_threshold(ratio, k, log_prior) for k in STRENGTHS]).min(axis=0)
        return np.where(size > 0, (np.sqrt(need) + POWER) / np.sqrt(size), np.inf)


def _threshold(ratio: Array, kappa: float, log_prior: float) -> Array:
    """(w,) χ² at which one amplitude makes the group's e-value 1/α."""
    grown = np.maximum(kappa**2 * ratio, 1e-12)
    enough = ENOUGH - log_prior - np.log(FORMS[SAME]) + np.log(len(STRENGTHS))
    return np.asarray(2 * (enough + 0.5 * np.log1p(grown)) * (1 + grown) / grown)


def _limit(known: Signature, smallest: list[Array]) -> Limit:
    """The largest of what several places need."""
    units = cause(known.identifier).units
    if not smallest:
        return Limit(known.identifier, None, units, "no session has what it needs")
    largest = np.max(smallest, axis=0)
    if not np.isfinite(largest).any():
        return Limit(known.identifier, None, units, "the calibrations absorb it completely")
    return Limit(known.identifier, tuple(float(x) for x in largest if np.isfinite(x)), units, "")
