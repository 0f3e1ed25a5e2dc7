"""One place of a group in every session: causes of the catalogue and terms of the library, side by side.

A place is a sensor of a unit or of a type, every sensor of a kind, or the applied vector on a stand. What was found
elsewhere is left free in each session, so that what is asked here does not hang on it.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.whitened import INVISIBLE, WhitenedResiduals
from estimator.groups.candidates import columns_of
from estimator.groups.joint_fit import JointFit
from estimator.groups.layout import EVERY, GroupHypothesis
from estimator.groups.library import library
from estimator.groups.scores import LEFT, batch, shrinkage
from estimator.groups.statistics import HARMONIC, SessionStatistics
from estimator.groups.weighing import weighed_forms
from estimator.least_squares import inverse, orthonormal, scale_of
from estimator.session import Array

Key = tuple[str, ...]
"""A candidate of a place: a cause with its shape, or the words of a term."""


class Where(NamedTuple):
    """A place of a group."""

    level: str
    subject: str
    sensor: str
    kind: str

    @classmethod
    def of(cls, h: GroupHypothesis) -> "Where":
        """The place of a hypothesis."""
        return cls(h.level, h.subject, h.sensor, h.kind)

    def concerns(self, s: SessionStatistics) -> bool:
        """Whether a session has this place."""
        return self.subject in (s.unit, s.unit_type, s.stand) and (self.sensor in ("", EVERY, *s.sensors))


def key_of(h: GroupHypothesis) -> Key:
    """A named hypothesis as a candidate of its place."""
    return h.cause, "" if h.shape is None else repr(h.shape)


def causes_at(baseline: Baseline, where: Where) -> dict[Key, Array]:
    """(R, m, w) columns of every cause, and nameless wave, at a place of a session."""
    found: dict[Key, Array] = {}
    for b, columns in columns_of(baseline):
        if b.sensor == where.sensor or (where.sensor == EVERY and b.kind == where.kind and b.width == 1):
            key = (b.cause, "" if b.shape is None else repr(b.shape))
            found[key] = found[key] + columns if key in found else columns
    return found


def terms_at(baseline: Baseline, where: Where) -> dict[Key, Array]:
    """(R, m, w) columns of every term of the library at a place of a session."""
    if where.sensor != EVERY:
        return {t.words: t.columns for t in library(baseline, where.sensor)}
    found: dict[Key, Array] = {}
    for sensor in baseline.session.sensors:
        for t in library(baseline, sensor.name) if sensor.kind == where.kind else ():
            found[t.words] = found[t.words] + t.columns if t.words in found else t.columns
    return found


@dataclass(frozen=True, eq=False)
class PlaceMoments:
    """Candidates of a place over n sessions. D columns, each of pooled norm one."""

    causes: tuple[Key, ...]
    terms: tuple[Key, ...]
    slots: dict[Key, Array]
    """Columns of every candidate."""
    U: Array
    """(n, D) scores."""
    F: Array
    """(n, D, D) information."""
    estimated: Array
    """(n,) degrees of freedom from which the noise of each session is estimated; infinite where it is as stated."""

    @cached_property
    def whole(self) -> Array:
        """(D, D) information of the pool."""
        return np.asarray(self.F.sum(axis=0))

    def given(self, shared: Sequence[Key] = (), free: Sequence[Key] = ()) -> "PlaceInput":
        """The statistics with some candidates in the fit: of one amplitude in all sessions, or of one in each."""
        U, F = self.U, self.F
        if free:
            freed = np.concatenate([self.slots[k] for k in free])
            gain = np.array([f[:, freed] @ inverse(f[np.ix_(freed, freed)]) for f in F])
            U = U - (gain @ U[:, freed, None])[..., 0]
            F = _cleared(F - gain @ F[:, freed], F)
        whole = F.sum(axis=0) if free else self.whole
        if not shared:
            return PlaceInput(self, U, F, whole)
        at = np.concatenate([self.slots[k] for k in shared])
        fit, cross = JointFit(U[:, at], F[:, at[:, None], at]), F[:, :, at]
        return PlaceInput(self, U - fit.explains(cross), F, _cleared(whole - fit.absorbs(cross), self.whole))


@dataclass(frozen=True, eq=False)
class PlaceInput:
    """Candidates of a place given some of them."""

    moments: PlaceMoments
    U: Array
    F: Array
    whole: Array
    """(D, D) information of the pool, given what all sessions share."""

    def evidence(self, keys: Sequence[Key]) -> dict[Key, tuple[Array, float]]:
        """ln Bayes factor (3,) in each form, the form's prior share included, and χ² in the pool, of each candidate."""
        found: dict[Key, tuple[Array, float]] = {}
        for width in {len(self.moments.slots[k]) for k in keys}:
            alike = [k for k in keys if len(self.moments.slots[k]) == width]
            at = np.array([self.moments.slots[k] for k in alike])
            F = self.F[:, at[:, :, None], at[:, None, :]]
            U = as_normal(self.U[:, at], F, self.moments.estimated)
            whole = self.whole[at[:, :, None], at[:, None, :]]
            alone = self.moments.whole[at, at]
            gone = (np.diagonal(whole, axis1=1, axis2=2) <= LEFT * alone).all(axis=1)
            total = np.where(gone[:, None], 0.0, U.sum(axis=0))
            forms, _ = weighed_forms(U, F, total, np.where(gone[:, None, None], 0.0, whole), np.ones(len(alike), bool))
            forms[:, gone] = -np.inf
            statistic, _ = batch(total, whole)
            found |= {k: (forms[:, j], float(statistic[j])) for j, k in enumerate(alike)}
        return found


def _cleared(left: Array, before: Array) -> Array:
    """Information with the columns taken out of which next to nothing is left."""
    gone = np.diagonal(left, axis1=-2, axis2=-1) <= LEFT * np.diagonal(before, axis1=-2, axis2=-1)
    return np.where(gone[..., :, None] | gone[..., None, :], 0.0, left)


@dataclass(frozen=True, eq=False)
class PlacedFit:
    """A session as it is pooled."""

    record: SessionStatistics
    baseline: Baseline
    scale: float
    """Factor by which its variance exceeds the stated one."""

    def elsewhere(self, places: Sequence[tuple[Where, Key]]) -> Iterator[Array]:
        """(R, m, w) columns of what was found at other places."""
        for where in dict.fromkeys(w for w, _ in places):
            if where.concerns(self.record):
                columns = causes_at(self.baseline, where)
                yield from (columns[key] for w, key in places if w == where and key in columns)


@dataclass(frozen=True, eq=False)
class Traced:
    """A session at a place."""

    traces: dict[Key, Array]
    """(N, w) trace of every candidate, standard errors per unit amplitude."""
    causes: frozenset[Key]
    """The candidates that the catalogue has."""
    z: Array
    """(N,) standard errors."""


def moments_at(
    where: Where, whole: Sequence[PlacedFit], elsewhere: Sequence[Sequence[tuple[Where, Key]]]
) -> PlaceMoments:
    """Candidates of a place over sessions; ``elsewhere``: of each session, what else acts in it."""
    traced = [_traced(where, fit, others) for fit, others in zip(whole, elsewhere, strict=True)]
    widths = {key: trace.shape[1] for x in traced for key, trace in x.traces.items()}
    ends = np.cumsum([0, *widths.values()])
    slots = {key: np.arange(a, b) for key, a, b in zip(widths, ends, ends[1:], strict=False)}
    U, F = np.zeros((len(traced), ends[-1])), np.zeros((len(traced), ends[-1], ends[-1]))
    for k, x in enumerate(traced):
        at = np.concatenate([slots[key] for key in x.traces])
        X = np.concatenate(list(x.traces.values()), axis=1)
        U[k, at], F[k][np.ix_(at, at)] = X.T @ x.z, X.T @ X
    unit = scale_of(F.sum(axis=0))
    causes = frozenset[Key]().union(*(x.causes for x in traced))
    named_keys, terms = [tuple(key for key in widths if (key in causes) == named) for named in (True, False)]
    estimated = np.array([_estimated(where, fit) for fit in whole])
    return PlaceMoments(named_keys, terms, slots, U * unit, F * unit[:, None] * unit, estimated)


def _traced(where: Where, fit: PlacedFit, others: Sequence[tuple[Where, Key]]) -> "Traced":
    """A session at a place, what acts elsewhere left free."""
    residuals = WhitenedResiduals.of(fit.baseline)
    free = [residuals.trace(columns) for columns in fit.elsewhere(others)]
    basis = np.zeros((len(residuals.z), 0))
    if free:
        basis = orthonormal(np.concatenate(free, axis=1), 1e-3)
    named = {k: c for k, c in causes_at(fit.baseline, where).items() if k[0] != HARMONIC}
    whole = named | terms_at(fit.baseline, where)
    white = residuals.whitened(np.concatenate(list(whole.values()), axis=-1))
    trace = residuals.remaining_of(white)
    trace = trace - basis @ (basis.T @ trace)
    seen = np.linalg.norm(trace, axis=0) > INVISIBLE * np.maximum(np.linalg.norm(white, axis=0), 1e-300)
    ends = np.cumsum([columns.shape[-1] for columns in whole.values()])
    traces = dict(zip(whole, np.split(trace * seen / np.sqrt(fit.scale), ends[:-1], axis=1), strict=True))
    z = (residuals.z - basis @ (basis.T @ residuals.z)) / np.sqrt(fit.scale)
    return Traced(traces, frozenset(named), z)


def _estimated(where: Where, fit: PlacedFit) -> float:
    """Degrees of freedom from which a session's noise at a place is estimated; infinite where it is as stated."""
    record = fit.record
    concerned = np.array([where.sensor in ("", EVERY, name) for name in record.sensors])
    doubtful = fit.baseline.unstated | (record.noise_factor != 1)
    return float(record.freedom[concerned].sum()) if (concerned & doubtful).any() else np.inf


def as_normal(U: Array, F: Array, freedom: Array) -> Array:
    """(n, H, w) scores U as unlikely as normal ones where noise is estimated from ``freedom`` (n,) degrees of freedom;
    F (n, H, w, w)."""
    estimated = np.flatnonzero(np.isfinite(freedom))
    if not len(estimated):
        return U
    n, H, w = U[estimated].shape
    statistic, q = batch(U[estimated].reshape(n * H, w), F[estimated].reshape(n * H, w, w))
    shrunk = U.copy()
    shrunk[estimated] *= shrinkage(statistic, q, np.repeat(freedom[estimated], H)).reshape(n, H, 1)
    return shrunk
