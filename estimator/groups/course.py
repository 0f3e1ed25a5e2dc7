"""An unknown course at a place of a group: the rival of every name there.

Theory
------
A course that no cause describes is a sum of few terms of the library (`library`), each of them as likely beforehand,
all together in the odds `OUTSIDE` of the names. At a place, a sensor or the applied vector, names and courses are
weighed on the readings of the sessions by the evidence of the group's model: the names alone, with each in place of the
last of them; the terms of the library that explain most, alone; and one beside the other. What was found elsewhere is
left free in every session, so that the answer does not hang on it. Explanations are held against one another here, not
against chance, so that scores enter in full even where the sessions themselves give the noise. The probability of the
course is that of all sets with a term of the library among all sets. Where it is the likelier the names are withdrawn,
but for those that the terms leave needed, and the search is made anew without the place.

A signature describes its cause nearly: a course beside names that explains less than `NEARLY` of what they do is part
of them.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.whitened import INVISIBLE, WhitenedResiduals
from estimator.groups.candidates import columns_of
from estimator.groups.evidence import log_sum
from estimator.groups.layout import EVERY
from estimator.groups.library import library
from estimator.groups.pool import LIBRARY, GroupHypothesis, GroupTerm, Part, Place, Pool
from estimator.groups.priors import DOUBT, ENOUGH, FURTHER, NEARLY, OUTSIDE
from estimator.groups.search import GroupModel, WeighedPool, search, weigh
from estimator.groups.session_statistics import as_kept
from estimator.groups.statistics import HARMONIC, SessionStatistics
from estimator.least_squares import orthonormal
from estimator.session import Array, CalibrationSession

LONGEST = 4
"""Terms of one course, and places with a course; what needs more is no simple law."""

SPANNED = 1e-3
"""Share of a term's information that no single cause may reach, for the term to be beyond the catalogue."""


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
        return self.subject in s.subjects and (self.sensor in ("", EVERY, *s.sensors))


@dataclass(frozen=True, eq=False)
class FittedSession:
    """A session of a group as its record took it."""

    record: SessionStatistics
    baseline: Baseline
    scale: float
    """Factor by which its variance exceeds the stated one."""
    known: dict[Where, dict[GroupHypothesis, Array]] = field(default_factory=dict)
    """Columns of the places that were asked for."""

    @cached_property
    def residuals(self) -> WhitenedResiduals:
        return WhitenedResiduals.of(self.baseline)

    def columns(self, where: Where) -> dict[GroupHypothesis, Array]:
        """(R, m, w) columns of every cause, wave and term of the library at a place."""
        if where not in self.known:
            self.known[where] = self._columns(where)
        return self.known[where]

    def _columns(self, where: Where) -> dict[GroupHypothesis, Array]:
        found: dict[GroupHypothesis, Array] = {}

        def add(cause: str, shape: float | None, words: tuple[str, ...], columns: Array) -> None:
            h = GroupHypothesis(*where[:2], cause, *where[2:], shape, columns.shape[-1], words)
            found[h] = found[h] + columns if h in found else columns

        for b, columns in columns_of(self.baseline):
            if b.sensor == where.sensor or (where.sensor == EVERY and b.kind == where.kind and b.width == 1):
                add(b.cause, b.shape, (), columns)
        for sensor in self.baseline.session.sensors:
            if where.sensor == sensor.name or (where.sensor == EVERY and where.kind == sensor.kind):
                for term in library(self.baseline, sensor.name):
                    add(LIBRARY, None, term.words, term.columns)
        for term in library(self.baseline, "") if not where.sensor else ():
            add(LIBRARY, None, term.words, term.columns)
        return found

    def part(self, where: Where, elsewhere: Sequence[GroupHypothesis], numbers: dict[GroupHypothesis, Place]) -> Part:
        """The session in the pool of a place, what acts ``elsewhere`` left free; ``numbers`` gets new hypotheses."""
        others = [self.columns(Where.of(h)).get(h) for h in elsewhere]
        free = [self.residuals.trace(columns) for columns in others if columns is not None]
        basis = orthonormal(np.concatenate(free, axis=1), 1e-3) if free else np.zeros((len(self.residuals.z), 0))
        columns = {h: c for h, c in self.columns(where).items() if h.cause != HARMONIC}
        white = self.residuals.whitened(np.concatenate(list(columns.values()), axis=-1))
        trace = self.residuals.remaining_of(white)
        trace = trace - basis @ (basis.T @ trace)
        seen = np.linalg.norm(trace, axis=0) > INVISIBLE * np.maximum(np.linalg.norm(white, axis=0), 1e-300)
        trace = trace * seen / np.sqrt(self.scale)
        z = (self.residuals.z - basis @ (basis.T @ self.residuals.z)) / np.sqrt(self.scale)
        score, information = trace.T @ z, trace.T @ trace
        ends = np.cumsum([0, *(h.width for h in columns)])
        at: dict[int, list[tuple[int, Array]]] = {}
        for h, start in zip(columns, ends.tolist(), strict=False):
            place = numbers.setdefault(h, (h.width, sum(w == h.width for w, _ in numbers.values())))
            at.setdefault(h.width, []).append((place[1], start + np.arange(h.width)))
        return Part(
            subjects=self.record.subjects,
            scale=self.scale,
            score=score,
            shrink=np.ones(len(score)),
            reach=np.zeros(len(score)),
            information=lambda rows, columns: np.asarray(information[rows, columns]),
            numbers={w: np.array([k for k, _ in rows]) for w, rows in at.items()},
            columns={w: np.array([c for _, c in rows]) for w, rows in at.items()},
        )


def placed(where: Where, fits: Sequence[FittedSession], elsewhere: Sequence[Sequence[GroupHypothesis]]) -> Pool:
    """Causes and terms of the library at a place over sessions; ``elsewhere``: what else acts in each of them."""
    numbers: dict[GroupHypothesis, Place] = {}
    parts = [fit.part(where, others, numbers) for fit, others in zip(fits, elsewhere, strict=True)]
    hypotheses = {w: tuple(h for h, place in numbers.items() if place[0] == w) for w, _ in numbers.values()}
    named = [h for h in numbers if not h.nameless]
    shapes = {h.cause: sum(x.cause == h.cause for x in named) for h in named}
    share = {h: 1 / len(shapes) / shapes[h.cause] for h in named}
    terms = len(numbers) - len(named)
    log_prior = {w: np.array([np.log(share.get(h, OUTSIDE / terms)) for h in table]) for w, table in hypotheses.items()}
    pool = Pool(hypotheses, log_prior, tuple(parts))
    for place in spanned(pool):
        log_prior[place[0]][place[1]] = -np.inf
    return pool


def spanned(pool: Pool) -> list[Place]:
    """The terms of the library that a single cause describes as well."""
    alone = pool.given()
    left = {w: np.full(len(table), np.inf) for w, table in pool.hypotheses.items()}
    size = {w: np.diagonal(m.F.sum(axis=0), axis1=1, axis2=2) for w, m in alone.moments.items()}
    for h, place in pool.places.items():
        if not h.nameless:
            given = pool.given([GroupTerm(place, pool.acting(place), True)])
            for w, m in given.moments.items():
                rest = size[w] - np.diagonal(m.lost, axis1=1, axis2=2)
                share = (rest / np.where(size[w] > 0, size[w], np.inf)).max(axis=1)
                left[w] = np.minimum(left[w], share)
    return [place for h, place in pool.places.items() if h.nameless and left[place[0]][place[1]] <= SPANNED]


@dataclass(frozen=True)
class CoursePath:
    """Terms of a place one after another, each the likeliest given those before."""

    terms: tuple[GroupTerm, ...] = ()
    log_evidence: float = 0.0
    """ln of prior share times Bayes factor of the set."""
    neighbours: float = -np.inf
    """ln of the same of all sets with another term in place of the last."""
    statistic: float = 0.0
    """χ² that the terms explain."""


def along(pool: Pool, path: CoursePath, wanted: Sequence[Place]) -> CoursePath:
    """A path with terms for names that were found."""
    for place in wanted:
        path = _with(pool, path, weigh(pool.given(path.terms)), place)
    return path


def with_course(pool: Pool, path: CoursePath, at_least: float = -np.inf) -> CoursePath:
    """A path with the likeliest terms of the library: one with ``at_least`` that evidence, and as many more as gain."""
    for k in range(LONGEST):
        weighed = weigh(pool.given(path.terms))
        ranked = weighed.ranked(nameless=True)
        if not ranked or ranked[0][2] < (max(at_least, 0.0) if k else at_least):
            break
        path = _with(pool, path, weighed, ranked[0][0])
    return path


def with_names(pool: Pool, path: CoursePath, names: Sequence[GroupHypothesis]) -> CoursePath:
    """A path with those of some names that are sure beside it, the strongest first."""
    rest = [pool.places[h] for h in names]
    while rest:
        weighed = weigh(pool.given(path.terms))
        best = max(rest, key=weighed.evidence_of)
        if weighed.evidence_of(best) < ENOUGH + FURTHER:
            break
        path = _with(pool, path, weighed, best)
        rest.remove(best)
    return path


def _with(pool: Pool, path: CoursePath, weighed: WeighedPool, place: Place) -> CoursePath:
    """A path with one more term: a course has the odds of the library once; another effect beside costs `FURTHER`."""
    h, before = pool[place], [pool[t.place] for t in path.terms]
    price = 0.0 if not before else -np.log(OUTSIDE) if h.nameless and before[-1].nameless else -FURTHER
    others = float(log_sum(np.array([v for _, _, v in weighed.ranked(h.nameless)])))
    return CoursePath(
        (*path.terms, weighed.term(place)),
        path.log_evidence + weighed.evidence_of(place) + price,
        path.log_evidence + others + price,
        path.statistic + float(weighed.widths[place[0]].statistic[place[1]]),
    )


@dataclass(frozen=True)
class CourseJudgement:
    """The names at a place beside an unknown course."""

    probability: float
    """Probability of the course."""
    course: tuple[GroupHypothesis, ...]
    """The terms of the library that explain most."""
    statistic: float
    """χ² that they explain."""
    kept: tuple[GroupHypothesis, ...]
    """Names that hold."""
    withdrawn: tuple[GroupHypothesis, ...]
    """Names that do not."""
    fits: bool
    """Whether the names describe the place."""


def judged(pool: Pool, names: Sequence[GroupHypothesis]) -> CourseJudgement:
    """The names at a place held against a course that no cause describes."""
    named = along(pool, CoursePath(), [pool.places[h] for h in names])
    beside, course = with_course(pool, named), with_course(pool, CoursePath())
    both = with_names(pool, course, names)
    nearly = beside.statistic - named.statistic < NEARLY * named.statistic
    as_named = [named.neighbours, *([beside.log_evidence - np.log(OUTSIDE)] if nearly else [])]
    unknown = [course.neighbours]
    unknown += [path.log_evidence for path in (both, *(() if nearly else (beside,))) if path.terms != course.terms]
    likely, unlikely = log_sum(np.array(as_named)), log_sum(np.array(unknown))
    probability = float(1 / (1 + np.exp(np.clip(likely - unlikely, -700, 700))))
    fits = likely >= unlikely
    terms = tuple(pool[t.place] for t in course.terms)
    kept = tuple(names) if fits else tuple(h for t in both.terms if not (h := pool[t.place]).nameless)
    withdrawn = tuple(h for h in names if h not in kept)
    return CourseJudgement(probability, terms, course.statistic, kept, withdrawn, bool(fits))


@dataclass(frozen=True, eq=False)
class AnsweredGroup:
    """The model of a group, held against unknown courses."""

    model: GroupModel
    records: tuple[SessionStatistics, ...]
    fits: tuple[FittedSession, ...]
    """The latest sessions, as many as are at hand."""
    courses: dict[Where, CourseJudgement]
    """Places with a course that no cause describes."""
    doubted: frozenset[GroupHypothesis]
    """Names that may as well be such a course."""

    def at(self, where: Where) -> list[FittedSession]:
        """The sessions at hand that have a place."""
        return [fit for fit in self.fits if where.concerns(fit.record)]

    def pool(self, where: Where) -> Pool:
        """Causes and terms of a place over its sessions, what was found elsewhere left free."""
        model, first = self.model, len(self.records) - len(self.fits)
        elsewhere = []
        for k, fit in enumerate(self.fits, first):
            if where.concerns(fit.record):
                acting = [t for t in (*model.own, *model.aside) if k in t.sessions]
                found = (model.pool[t.place] for t in (*acting, *model.terms))
                elsewhere.append([h for h in found if Where.of(h) != where])
        return placed(where, self.at(where), elsewhere)


def answered(
    pool: Pool,
    records: Sequence[SessionStatistics],
    sessions: Sequence[CalibrationSession],
    barred: frozenset[tuple[str, ...]] = frozenset(),
) -> AnsweredGroup:
    """The model of a group whose names hold against a course at their place.

    ``sessions``: of the latest records, as many as are at hand. A name that none of them can show is in doubt: a record
    holds the scores of the catalogue, and those of the library would make it five times as large.
    """
    first, model = len(records) - len(sessions), search(GroupModel(pool, barred=barred))
    latest = zip(sessions, records[first:], pool.parts[first:], strict=True) if model.terms else ()
    fits = tuple(FittedSession(record, as_kept(s, record), part.scale) for s, record, part in latest)
    answer = AnsweredGroup(model, tuple(records), fits, {}, frozenset())
    while True:
        asked = {where: named for where, named in names_by_place(answer.model).items() if where not in answer.courses}
        pools = {where: answer.pool(where) for where in asked if answer.at(where)}
        names = {where: [h for h in asked[where] if h in pool.places] for where, pool in pools.items()}
        judgements = {where: judged(pools[where], named) for where, named in names.items() if named}
        wrong = {where: says for where, says in judgements.items() if not says.fits}
        if not wrong or len(answer.courses) == LONGEST:
            break
        where = max(wrong, key=lambda where: wrong[where].statistic)
        answer = replace(
            answer,
            model=searched_again(answer.model, where, wrong[where].kept, names[where]),
            courses=answer.courses | {where: wrong[where]},
        )
    sure = {h for where, says in judgements.items() if says.probability < DOUBT for h in names[where]}
    named = [answer.model.pool[t.place] for t in answer.model.named]
    return replace(answer, doubted=frozenset(named) - sure)


def names_by_place(model: GroupModel) -> dict[Where, list[GroupHypothesis]]:
    """The names of every place."""
    named = [model.pool[t.place] for t in model.named]
    return {where: [h for h in named if Where.of(h) == where] for where in dict.fromkeys(map(Where.of, named))}


def searched_again(
    model: GroupModel, where: Where, kept: Sequence[GroupHypothesis], names: Sequence[GroupHypothesis]
) -> GroupModel:
    """The search without a place: it is left free in every session, or for the names that hold there alone."""
    pool, barred = model.pool, model.barred | {h.group for h in names if h not in kept}
    if kept:
        there = {h.group for h in pool.places if Where.of(h) == where and not h.nameless}
        return search(GroupModel(pool, aside=model.aside, barred=barred | there - {h.group for h in kept}))
    free = tuple(
        GroupTerm(place, acting, False)
        for h, place in pool.places.items()
        if (h.sensor, h.kind) == (where.sensor, where.kind)
        for acting in [tuple(k for k in pool.acting(place) if where.subject in pool.parts[k].subjects)]
        if acting
    )
    return search(GroupModel(pool, aside=(*model.aside, *free), barred=barred))
