"""A course that no cause describes, written out: its equation, its gain on sessions that took no part, its picture.

The terms of the library that the sessions show most, each with an e-value of 1/α, are fitted to two of three sessions.
As many of them are kept as predict the others best. A learned term describes; it names no physical cause.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from estimator.groups.course import AnsweredGroup, CoursePath, FittedSession, Where, with_course
from estimator.groups.joint_fit import JointFit
from estimator.groups.library import library
from estimator.groups.pictures import Pictured, drawn, left_without, pooled_picture
from estimator.groups.pool import GroupHypothesis, GroupTerm, Pool
from estimator.groups.priors import ENOUGH, TYPE
from estimator.groups.results import EmpiricalTerm, Picture
from estimator.least_squares import inverse
from estimator.message import joined
from estimator.session import Array

HELD_OUT = 3
"""Every third session takes no part in the fit: enough are left to fit, and both parts reach over the group's life."""

FEWEST = 4
"""Sessions from which on there is something to fit and to confirm."""


@dataclass(frozen=True, eq=False)
class LearnedCourse:
    """Terms of the library at a place with their fit to n sessions, names that hold there left free. a amplitudes."""

    pool: Pool
    terms: tuple[GroupTerm, ...]
    names: tuple[GroupTerm, ...]

    @property
    def hypotheses(self) -> list[GroupHypothesis]:
        """The terms of the library."""
        return [self.pool[t.place] for t in self.terms]

    def split(self) -> tuple[JointFit, JointFit]:
        """The fit to the sessions that take part, and to those left out."""
        whole = self.pool.given([*self.names, *self.terms]).fit
        held = np.arange(len(whole.U)) % HELD_OUT == HELD_OUT - 1
        return JointFit(whole.U[~held], whole.F[~held]), JointFit(whole.U[held], whole.F[held])

    @property
    def gain(self) -> float:
        """Log predictive density of the sessions left out that the terms gain."""
        fit, held = self.split()
        return fit.predicts(held)


def learned_terms(answer: AnsweredGroup, level: str) -> Iterator[EmpiricalTerm]:
    """The course of every place where the sessions at hand share structure that no cause explains.

    What a sensor shows in a group of a type is looked for in all units of the type.
    """
    model, last = answer.model, answer.records[-1]
    found = [*answer.courses, *(Where.of(model.pool[t.place]) for t in model.nameless)]
    wider = (
        where._replace(level=TYPE, subject=last.unit_type) if level == TYPE and where.sensor else where
        for where in found
    )
    for where in dict.fromkeys(wider):
        learned = learn(answer, where)
        if learned is not None:
            yield shown(where, learned, answer.at(where))


def learn(answer: AnsweredGroup, where: Where) -> LearnedCourse | None:
    """The course of a place; None where nothing is sure enough, or nothing holds in the sessions left out."""
    if len(answer.at(where)) < FEWEST:
        return None
    pool = answer.pool(where)
    named = [h for t in answer.model.named for h in [answer.model.pool[t.place]] if h in pool.places]
    names = tuple(GroupTerm(pool.places[h], pool.acting(pool.places[h]), False) for h in named)
    fitted = tuple(part for k, part in enumerate(pool.parts) if k % HELD_OUT != HELD_OUT - 1)
    path = with_course(replace(pool, parts=fitted), CoursePath(names), ENOUGH).terms[len(names) :]
    terms = tuple(GroupTerm(t.place, pool.acting(t.place), True) for t in path)
    courses = [LearnedCourse(pool, terms[: k + 1], names) for k in range(len(terms))]
    best = max(courses, key=lambda c: c.gain, default=None)
    return best if best is not None and best.gain > 0 else None


def shown(where: Where, learned: LearnedCourse, fits: Sequence[FittedSession]) -> EmpiricalTerm:
    """The course of a place as people see it."""
    fit, held = learned.split()
    known = {t.words: t for one in fits for t in library(one.baseline, where.sensor)}
    hypotheses = learned.hypotheses
    units = tuple(known[h.words].unit for h in hypotheses for _ in h.words)
    left_out = [one for k, one in enumerate(fits) if k % HELD_OUT == HELD_OUT - 1]
    excess = sum(float(x.residuals.z @ x.residuals.z) / x.scale - x.residuals.freedom for x in left_out)
    nearest, apart = nearest_cause(learned, fit.amplitude)
    sigma = np.sqrt(np.diagonal(fit.covariance))
    words = tuple(word for h in hypotheses for word in h.words)
    parts = [f"({v:.3g} ± {s:.1g}) {u}·{w}" for v, s, u, w in zip(fit.amplitude, sigma, units, words, strict=True)]
    return EmpiricalTerm(
        equation=joined(" + ", parts),
        words=words,
        sensors=(where.sensor,) if where.sensor else (),
        subject=where.subject,
        amplitude=tuple(fit.amplitude.tolist()),
        sigma=tuple(sigma.tolist()),
        units=units,
        gain=fit.predicts(held),
        explained=float(np.clip(fit.reduces(held) / excess, 0.0, 1.0)) if excess > 0 else 0.0,
        nearest=nearest,
        separation=apart,
        picture=picture(where, hypotheses, fit.amplitude, fits, known[hypotheses[0].words].variable),
        level=where.level,
    )


def nearest_cause(learned: LearnedCourse, amplitude: Array) -> tuple[str, float]:
    """The cause at the place that comes nearest, and how far it stays, standard errors on the pool."""
    given = learned.pool.given(learned.terms)
    total = float(amplitude @ given.fit.F.sum(axis=0) @ amplitude)
    left = {
        h.cause: total - float(alike @ inverse(given.moments[w].F[:, k].sum(axis=0)) @ alike)
        for h, (w, k) in learned.pool.places.items()
        if not h.nameless
        for alike in [given.moments[w].cross[:, k].sum(axis=0) @ amplitude]
    }
    nearest = min(left, key=lambda cause: left[cause], default="")
    return nearest, float(np.sqrt(max(left.get(nearest, total), 0.0)))


def picture(
    where: Where, hypotheses: Sequence[GroupHypothesis], amplitude: Array, fits: Sequence[FittedSession], variable: str
) -> Picture:
    """Pooled residual of the place against a variable, before and after."""
    parts: list[Pictured] = []
    subject = where.sensor or hypotheses[0].words[0].partition(":")[0]
    for fit in fits:
        columns = fit.columns(where)
        ends = np.cumsum([0, *(h.width for h in hypotheses)])
        effect = np.zeros(fit.baseline.residual.shape)
        for k, h in enumerate(hypotheses):
            effect += columns[h] @ amplitude[ends[k] : ends[k + 1]] if h in columns else 0.0
        parts += list(drawn(fit.baseline, left_without(fit.residuals, effect), subject, variable))
    return pooled_picture(parts, variable, subject)
