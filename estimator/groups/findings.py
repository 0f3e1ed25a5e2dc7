"""Turns the model of a group into findings that people read: amplitudes, forest plots, rivals, structure."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from estimator.causes.catalogue import UNEXPLAINED, cause
from estimator.diagnosis.explanation.naming import sentence
from estimator.diagnosis.explanation.rivals import CREDIBLE, DISTINGUISHED
from estimator.groups.course import AnsweredGroup, Where
from estimator.groups.evidence import log_sum
from estimator.groups.layout import EVERY
from estimator.groups.pool import Given, GroupHypothesis, GroupTerm, Place
from estimator.groups.priors import SINCE, TYPE, VARYING
from estimator.groups.random_effects import Mean, mean_of
from estimator.groups.results import GroupFinding, GroupRival, GroupStructure, SessionAmplitude
from estimator.groups.search import WeighedPool
from estimator.least_squares import inverse
from estimator.message import joined, say
from estimator.session import GYROSCOPE, Array

DIFFERENT = 0.01
"""p-value below which sessions differ in the size of what one amplitude should describe."""

FORM_WORDS = ("same", "varying", "since")
LARGEST = 700.0
"""ln of the largest number that a double holds, about."""


@dataclass(frozen=True, eq=False)
class Near:
    """A rival of a finding."""

    place: Place
    hypothesis: GroupHypothesis
    probability: float
    separation: float


@dataclass(frozen=True, eq=False)
class PooledEffect:
    """The pool's evidence on one named term, given the rest of the model. n sessions, w amplitudes."""

    term: GroupTerm
    hypothesis: GroupHypothesis
    mean: Mean
    U: Array
    """(n, w) 1/SI."""
    F: Array
    """(n, w, w) 1/SI²."""
    weighed: WeighedPool
    """All hypotheses without the term."""
    rivals: tuple[Near, ...]

    @property
    def differs(self) -> bool:
        """Whether sessions have it in different sizes: a cause is one constant, and what no catalogue has looks so."""
        return self.term.form == VARYING or self.mean.cochran < DIFFERENT

    @property
    def strength(self) -> float:
        """Standard errors of a reading: of the pool, or of the sessions one by one where the effect differs."""
        if self.term.form == VARYING:
            return float(np.sqrt(sum(float(u @ inverse(f) @ u) for u, f in zip(self.U, self.F, strict=True))))
        if self.term.form == SINCE:
            U, F = (x[list(self.term.sessions)].sum(axis=0) for x in (self.U, self.F))
            return float(np.sqrt(max(U @ inverse(F) @ U, 0.0)))
        w, k = self.term.place
        return float(np.sqrt(self.weighed.widths[w].statistic[k]))


def effect_of(answer: AnsweredGroup, term: GroupTerm) -> PooledEffect:
    """The pool's evidence on one named term."""
    model = answer.model
    weighed = model.weighed(without=term)
    w, k = term.place
    m = weighed.given.moments[w]
    U, F = m.U[:, k], m.F[:, k]
    seen = (np.diagonal(F, axis1=1, axis2=2).sum(axis=1) > 0) & np.isin(np.arange(len(F)), term.sessions)
    mean = with_joint(mean_of(U[seen], F[seen]), m.lost[k], F[seen].sum(axis=0))
    others = [replace(t, shared=False) for t in model.terms if t is not term]
    given = model.pool.given([*model.own, *model.aside, *others, replace(term, shared=True)])
    return PooledEffect(term, model.pool[term.place], mean, U, F, weighed, tuple(near(weighed, given, term, U, F)))


def near(weighed: WeighedPool, given: Given, term: GroupTerm, U: Array, F: Array) -> list[Near]:
    """Rivals that the pool does not tell from a term, most likely first.

    As within one session: those that hold the bulk of the probability together with it and lie near. ``given``: the
    term alone in the joint fit, all others left free in every session.
    """
    ranked = weighed.ranked()
    share = np.exp((values := np.array([value for _, _, value in ranked])) - log_sum(values))
    at, group = list(term.sessions), given.pool[term.place].group
    amplitude = np.array([inverse(F[s]) @ U[s] for s in at] if term.form == VARYING else [
        inverse(F[at].sum(axis=0)) @ U[at].sum(axis=0)
    ])  # fmt: skip

    def separation(rival: Place) -> float:
        """Norm of what is left of the term after the best fit of a rival, of one amplitude or of one a session."""
        m, k = given.moments[rival[0]], rival[1]
        information = (given.fit.F[at], m.cross[at, k], m.F[at, k])
        if term.form != VARYING:
            information = tuple(x.sum(axis=0, keepdims=True) for x in information)
        parts = zip(amplitude, *information, strict=True)
        square = sum(a @ (f - cross.T @ inverse(other) @ cross) @ a for a, f, cross, other in parts)
        return float(np.sqrt(max(square, 0.0)))

    reached, kept = 0.0, []
    for (place, hypothesis, _), p in zip(ranked, share.tolist(), strict=True):
        if reached >= CREDIBLE:
            break
        reached += p
        if hypothesis.group != group and (apart := separation(place)) < DISTINGUISHED:
            kept.append(Near(place, hypothesis, p, apart))
    return kept


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
    answer: AnsweredGroup, effect: PooledEffect, measurements: Sequence[tuple[str, int | None]]
) -> GroupFinding:
    """A finding as people see it; ``measurements`` what would separate each of its rivals."""
    term, h = effect.term, effect.hypothesis
    known = cause(h.cause)
    gyro = known.kind is None and h.kind == GYROSCOPE
    others = dict.fromkeys(n.hypothesis.cause for n in effect.rivals if n.hypothesis.cause != h.cause)
    beside = [where for where, _ in structures(answer)]
    doubted = h in answer.doubted or effect.differs or any(concerns(h, where) for where in beside)
    return GroupFinding(
        cause=h.cause,
        level=h.level,
        subject=h.subject,
        sensors=(h.sensor,) if h.sensor else (),
        kind=h.kind,
        amplitude=tuple(effect.mean.value.tolist()),
        sigma=tuple(s if s > 0 else None for s in effect.mean.sigma.tolist()),
        units=tuple(u.replace("m/s²", "rad/s") if gyro else u for u in known.units),
        spread=(effect.mean.spread,),
        shape=h.shape,
        form=FORM_WORDS[term.form],
        since=answer.records[term.since].started_at if term.form == SINCE else None,
        e_value=float(np.exp(min(effect.weighed.log_e_value, LARGEST))),
        strength=effect.strength,
        cochran=effect.mean.cochran,
        alternatives=(*others, *([UNEXPLAINED] if doubted else [])),
        rivals=tuple(rival_of(n, *m) for n, m in zip(effect.rivals, measurements, strict=True)),
        sentence=sentence(known, (words_of(h),) if h.sensor else ()),
        advice=known.advice,
        sessions=forest(answer, effect),
    )


def concerns(f: GroupHypothesis, structure: Where) -> bool:
    """Whether structure acts where a name does; structure on another stand does not."""
    if not f.sensor or not structure.sensor:
        return f.sensor == structure.sensor and f.subject == structure.subject
    return f.sensor in (structure.sensor, EVERY) and (f.level != "unit" or f.subject == structure.subject)


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


def forest(answer: AnsweredGroup, effect: PooledEffect) -> tuple[SessionAmplitude, ...]:
    """The amplitude of every session that speaks of a finding."""
    lines = []
    for s, part, U, F in zip(answer.records, answer.model.pool.parts, effect.U, effect.F, strict=True):
        size = np.diagonal(F)
        if part.columns_of(effect.term.place) is None or not size.any():
            continue
        covariance = inverse(F)
        sigma = tuple(
            float(np.sqrt(c)) if f > 0 and c > 0 else None for c, f in zip(np.diagonal(covariance), size, strict=True)
        )
        lines.append(SessionAmplitude(s.started_at, s.unit, tuple((covariance @ U).tolist()), sigma))
    return tuple(lines)


def structures(answer: AnsweredGroup) -> list[tuple[Where, GroupStructure]]:
    """Structure that the sessions share and no cause explains, with its place."""
    model = answer.model
    found = []
    for term in model.nameless:
        w, k = term.place
        h, statistic = model.pool[term.place], model.weighed(without=term).widths[w].statistic[k]
        found.append((h, say("harmonic {shape} of β", shape=f"{h.shape:g}"), float(statistic)))
    for says in answer.courses.values():
        words = joined(" + ", [word for h in says.course for word in h.words])
        found.append((says.course[0], words, says.statistic))
    listed = []
    for h, shape, statistic in found:
        where = (
            say("{hypothesis}: {shape}", hypothesis=words_of(h), shape=shape)
            if h.sensor
            else say("the applied vector, common to all sensors: {shape}", shape=shape)
        )
        sensors = (h.sensor,) if h.sensor else ()
        listed.append((Where.of(h), GroupStructure(where, h.subject, sensors, float(np.sqrt(statistic)))))
    return listed
