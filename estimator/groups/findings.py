"""Turns a group's selection into findings that people read: amplitudes, forest plots, rivals."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from estimator.causes.catalogue import UNEXPLAINED, cause
from estimator.diagnosis.explanation.naming import sentence
from estimator.diagnosis.explanation.rivals import CREDIBLE, DISTINGUISHED
from estimator.groups.evidence import SINCE, VARYING, log_sum
from estimator.groups.layout import EVERY, TYPE, GroupHypothesis
from estimator.groups.pool import Place, Pool, PoolModel, columns_in, pooled
from estimator.groups.random_effects import Mean, mean_of
from estimator.groups.results import GroupFinding, GroupRival, GroupStructure, SessionAmplitude
from estimator.groups.selection import Found, GroupSelection, concerns
from estimator.groups.weighing import Scale
from estimator.least_squares import inverse
from estimator.message import joined, say
from estimator.session import GYROSCOPE, Array


@dataclass(frozen=True, eq=False)
class Near:
    """A rival of a finding."""

    place: Place
    hypothesis: GroupHypothesis
    probability: float
    separation: float


@dataclass(frozen=True, eq=False)
class GroupSignature:
    """A finding in the n sessions that have it. w amplitudes."""

    found: Found
    sessions: tuple[int, ...]
    amplitude: Array
    """(n, w) SI, of every session where they differ; else (1, w) of all."""
    pool: Pool
    """The pool with the finding alone in the joint fit: all other effects are left free in every session."""

    @classmethod
    def of(cls, selection: GroupSelection, found: Found, base: Pool) -> "GroupSignature":
        """``base`` is the pool without the finding."""
        w, k = found.place
        U, F = base.moments[w].U[:, k], base.moments[w].F[:, k]
        shared = inverse(F[found.since :].sum(axis=0)) @ U[found.since :].sum(axis=0)
        parts = selection.layout.parts
        acts = tuple(s for s in range(found.since, len(parts)) if columns_in(parts[s], found.place) is not None)
        amplitude = [inverse(F[s]) @ U[s] for s in acts] if found.form == VARYING else [shared]
        model = PoolModel(absorbed=base.model.absorbed).with_shared(found.place, found.since)
        for other in base.model.shared:
            model = model.with_absorbed(range(other.since, len(parts)), other.place)
        return cls(found, acts, np.array(amplitude), pooled(selection.layout, model, selection.scale))

    def separation(self, rival: Place) -> float:
        """Norm of what is left of it after the best fit of a rival, of one amplitude or of one in every session."""
        w, k = rival
        moments, at = self.pool.moments[w], list(self.sessions)
        information = (self.pool.fit.F[at], moments.cross[at, k], moments.F[at, k])
        if self.found.form != VARYING:
            information = tuple(x.sum(axis=0, keepdims=True) for x in information)
        square = sum(
            a @ (f - cross.T @ inverse(other) @ cross) @ a
            for a, f, cross, other in zip(self.amplitude, *information, strict=True)
        )
        return float(np.sqrt(max(square, 0.0)))


def near(selection: GroupSelection, found: Found, scale: Scale) -> list[Near]:
    """Rivals that the pool does not tell from a finding, most likely first; ``scale`` is of the pool without it.

    As within one session: those that hold the bulk of the probability together with it and lie near.
    """
    ranked = list(scale.ranked())
    values = np.array([value for _, _, value in ranked])
    share = np.exp(values - log_sum(values))
    signature = GroupSignature.of(selection, found, scale.pool)
    reached, kept = 0.0, []
    for (place, hypothesis, _), p in zip(ranked, share, strict=True):
        if reached >= CREDIBLE:
            break
        reached += float(p)
        if hypothesis.group == found.hypothesis.group:
            continue
        apart = signature.separation(place)
        if apart < DISTINGUISHED:
            kept.append(Near(place, hypothesis, float(p), apart))
    return kept


DIFFERENT = 0.01
"""p-value below which sessions differ in the size of what one amplitude should describe."""

FORM_WORDS = ("same", "varying", "since")
LARGEST = 700.0
"""ln of the largest number that a double holds, about."""


@dataclass(frozen=True, eq=False)
class Estimated:
    """One finding with the pool's evidence on it. n sessions, w amplitudes."""

    found: Found
    mean: Mean
    U: Array
    """(n, w) 1/SI, given the other findings."""
    F: Array
    """(n, w, w) 1/SI²."""
    scale: Scale
    rivals: tuple[Near, ...]


def estimated(selection: GroupSelection, found: Found) -> Estimated:
    """The pool's evidence on one finding, given the others."""
    scale = selection.weighed(without=found)
    w, k = found.place
    m = scale.pool.moments[w]
    U, F = m.U[:, k], m.F[:, k]
    seen = (np.diagonal(F, axis1=1, axis2=2).sum(axis=1) > 0) & (np.arange(len(F)) >= found.since)
    mean = with_joint(mean_of(U[seen], F[seen]), m.lost[k], F[seen].sum(axis=0))
    return Estimated(found, mean, U, F, scale, tuple(near(selection, found, scale)))


def with_joint(mean: Mean, lost: Array, whole: Array) -> Mean:
    """The mean with what the joint fit of the other findings takes of its information (w, w), 1/SI², in its sigma.

    Their amplitudes were taken off at values that were fitted without this one, which shrinks it alike.
    """
    if not lost.any():
        return mean
    grown = inverse(whole - lost) @ whole
    sigma = np.sqrt(np.maximum(np.diagonal(grown), 1.0))
    return replace(mean, value=grown @ mean.value, sigma=mean.sigma * sigma, covariance=grown @ mean.covariance)


def finding_of(
    selection: GroupSelection, effect: Estimated, measurements: Sequence[tuple[str, int | None]]
) -> GroupFinding:
    """A finding as people see it; ``measurements`` what would separate each of its rivals."""
    f, h = effect.found, effect.found.hypothesis
    known = cause(h.cause)
    gyro = known.kind is None and h.kind == GYROSCOPE
    sensors = (h.sensor,) if h.sensor else ()
    weighed = effect.scale.weighed[f.place[0]]
    date = selection.layout.parts[f.since].statistics.started_at
    others = dict.fromkeys(n.hypothesis.cause for n in effect.rivals if n.hypothesis.cause != h.cause)
    doubted = h.group in selection.doubted or differs(effect) or any(concerns(h, s) for s, _ in selection.structures)
    beside = [UNEXPLAINED] if doubted else []
    return GroupFinding(
        cause=h.cause,
        level=h.level,
        subject=h.subject,
        sensors=sensors,
        kind=h.kind,
        amplitude=tuple(effect.mean.value.tolist()),
        sigma=tuple(s if s > 0 else None for s in effect.mean.sigma.tolist()),
        units=tuple(u.replace("m/s²", "rad/s") if gyro else u for u in known.units),
        spread=(effect.mean.spread,),
        shape=h.shape,
        form=FORM_WORDS[f.form],
        since=date if f.form == SINCE else None,
        e_value=float(np.exp(min(effect.scale.log_e_value, LARGEST))),
        strength=strength_of(effect, float(weighed.statistic[f.place[1]])),
        cochran=effect.mean.cochran,
        alternatives=(*others, *beside),
        rivals=tuple(rival_of(n, *m) for n, m in zip(effect.rivals, measurements, strict=True)),
        sentence=sentence(known, (words_of(h),) if h.sensor else ()),
        advice=known.advice,
        sessions=forest(selection, effect),
    )


def differs(effect: Estimated) -> bool:
    """Whether sessions have it in different sizes: a cause is one constant, and what no catalogue has looks so too."""
    return effect.found.form == VARYING or effect.mean.cochran < DIFFERENT


def strength_of(effect: Estimated, pooled: float) -> float:
    """Standard errors of a reading: of the pool, or of the sessions one by one where the effect differs."""
    if effect.found.form == VARYING:
        return float(np.sqrt(sum(float(u @ inverse(f) @ u) for u, f in zip(effect.U, effect.F, strict=True))))
    if effect.found.form == SINCE:
        U, F = effect.U[effect.found.since :].sum(axis=0), effect.F[effect.found.since :].sum(axis=0)
        return float(np.sqrt(max(U @ inverse(F) @ U, 0.0)))
    return float(np.sqrt(pooled))


def words_of(h: GroupHypothesis) -> str:
    """The place of a hypothesis, for people."""
    every = {"accelerometer": "every accelerometer", "gyroscope": "every gyro"}
    where = every.get(h.kind, "every sensor") if h.sensor == EVERY else h.sensor
    return say("{place} of type {subject}", place=where, subject=h.subject) if h.level == TYPE else where


def rival_of(near_by: Near, measurement: str, sessions: int | None) -> GroupRival:
    """A rival as people see it, and what would tell it apart."""
    h = near_by.hypothesis
    sensors = (h.sensor,) if h.sensor else ()
    return GroupRival(
        h.cause, sensors, h.level, h.subject, near_by.probability, near_by.separation, measurement, sessions
    )


def forest(selection: GroupSelection, effect: Estimated) -> tuple[SessionAmplitude, ...]:
    """The amplitude of every session that speaks of a finding."""
    lines = []
    for part, U, F in zip(selection.layout.parts, effect.U, effect.F, strict=True):
        size = np.diagonal(F)
        if columns_in(part, effect.found.place) is None or not size.any():
            continue
        covariance = inverse(F)
        sigma = tuple(
            float(np.sqrt(c)) if s > 0 and c > 0 else None for c, s in zip(np.diagonal(covariance), size, strict=True)
        )
        s = part.statistics
        lines.append(SessionAmplitude(s.started_at, s.unit, tuple((covariance @ U).tolist()), sigma))
    return tuple(lines)


def structures(selection: GroupSelection) -> tuple[GroupStructure, ...]:
    """Structure that the sessions share and no cause explains, in words."""
    found = []
    for h, statistic in selection.structures:
        shape = say("harmonic {shape} of β", shape=f"{h.shape:g}") if h.shape is not None else joined(" + ", h.words)
        where = (
            say("{hypothesis}: {shape}", hypothesis=words_of(h), shape=shape)
            if h.sensor
            else say("the applied vector, common to all sensors: {shape}", shape=shape)
        )
        found.append(GroupStructure(where, h.subject, (h.sensor,) if h.sensor else (), float(np.sqrt(statistic))))
    return tuple(found)
