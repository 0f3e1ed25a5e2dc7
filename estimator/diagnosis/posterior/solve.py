"""The likeliest terms of a session, in the noise that is likeliest with them."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
from scipy.special import logsumexp

from estimator.causes.contract import Signature
from estimator.diagnosis.posterior.applied_courses import AppliedCourses
from estimator.diagnosis.posterior.common_causes import CommonCauses
from estimator.diagnosis.posterior.curved import ResidualsOf, about_effects
from estimator.diagnosis.posterior.free_shared import FreeShared
from estimator.diagnosis.posterior.information import InputInformation
from estimator.diagnosis.posterior.moved_parameters import MovedParameters
from estimator.diagnosis.posterior.noise import (
    OtherNoise,
    beside,
    columns_of,
    of_noisy_sensors,
    of_quiet_sensors,
    off_by_a_factor,
    with_tails,
)
from estimator.diagnosis.posterior.noisy_sensors import NoisySensors
from estimator.diagnosis.posterior.own_courses import OwnCourses
from estimator.diagnosis.posterior.priors import FURTHER
from estimator.diagnosis.posterior.refine import refined
from estimator.diagnosis.posterior.search import Remainder, TermModel, search
from estimator.diagnosis.posterior.sensor_causes import SensorCauses
from estimator.diagnosis.posterior.shared_causes import SharedCauses
from estimator.diagnosis.posterior.term import NOISE, PlaceCandidate, Term
from estimator.diagnosis.posterior.wandering import WanderingZeros
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.likelihood import log_likelihood_ratio
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.session import Array

SEARCHES = 3
"""Searches at most, each in the noise that the terms of the one before leave."""

FACTORS = 3
"""Searches at most in noise that is off by a factor: the first takes effects that noise hid for noise."""

SETTLED = 0.05
"""Relative change of a variance below which it stands: hundreds of readings tell it to some per cent."""

ROUNDS = 2
"""Times that every shape is moved to its best beside the others."""

LOSES = 1.0
"""ln posterior odds that a candidate must lose beside a term to be a rival of it: a factor of e."""


@dataclass(frozen=True, eq=False)
class SessionTerms:
    """A session's residuals with all kinds of terms that may act in it."""

    residuals: WhitenedResiduals
    T: Array
    """(n, D) whitened residuals by a change of the inputs."""
    single: SensorCauses
    common: CommonCauses
    shared: SharedCauses
    model: TermModel

    @classmethod
    def of(cls, residuals: WhitenedResiduals, catalogue: Sequence[Signature], misfortunes: int = 0) -> "SessionTerms":
        """The kinds of a catalogue's causes, and those of everything else, where so many things happened besides."""
        causes = cls.of_causes(residuals, catalogue, misfortunes)
        makers = (OwnCourses, NoisySensors, WanderingZeros, MovedParameters)
        free = (*(make(residuals) for make in makers), AppliedCourses(residuals, causes.model.start))
        others = (*causes.model.of_others, *free)
        return replace(causes, model=replace(causes.model, of_others=others))

    @classmethod
    def of_causes(
        cls, residuals: WhitenedResiduals, catalogue: Sequence[Signature], misfortunes: int = 0
    ) -> "SessionTerms":
        """The kinds of a catalogue's causes alone, of one sensor, of all and of several."""
        start, T = InputInformation.of(residuals)
        single, common = SensorCauses(residuals, catalogue), CommonCauses(residuals, catalogue)
        shared = SharedCauses(single)
        model = TermModel(start, (single, common), (shared, FreeShared(residuals)), misfortunes)
        return cls(residuals, T, single, common, shared, model)


@dataclass(frozen=True, eq=False)
class Noisy:
    """A sensor noisier than stated."""

    sensor: int
    ratio: float
    """Variance over the stated one."""
    log_evidence: float
    """ln B against the stated noise."""
    log_prior: float
    course: float
    """Probability that it is an unknown course instead."""
    freedom: float
    """Number of readings that tell it."""


@dataclass(frozen=True, eq=False)
class TermSolution:
    """The likeliest terms of a session in one noise."""

    session: SessionTerms
    terms: tuple[Term, ...]
    log_evidence: float
    """ln posterior odds against nothing in the noise as stated."""
    noise: OtherNoise | None = None
    noisy: tuple[Noisy, ...] = field(default=())

    @property
    def here(self) -> Remainder:
        """The remainder beside all terms."""
        return self.session.model.beside(self.terms)

    def without(self, term: Term) -> Remainder:
        """The remainder beside the other terms."""
        return self.session.model.beside(tuple(t for t in self.terms if t is not term))

    def gained(self, term: Term) -> float:
        """ln B of a term beside the others."""
        return self.without(term).info.given(term.columns, term.variance, term.mean)[1]

    def rivals(self, term: Term) -> list[PlaceCandidate]:
        """The candidates that may stand in for a term, itself among them: they lose where it is there."""
        kinds = self.session.model.kinds
        with_it = {c.place: c.value for c in self.here.candidates(kinds)}
        every = self.without(term).candidates(kinds)
        return [c for c in every if c.place == term.place or c.value - with_it.get(c.place, -np.inf) > LOSES]

    def course(self, term: Term) -> float:
        """Probability that an unknown course, or another change that has no name, acts in place of a term."""
        near = self.rivals(term)
        unknown = [c.value for c in near if not c.named and c.place != term.place]
        return float(np.exp(logsumexp(unknown) - logsumexp([c.value for c in near] + [0.0]))) if unknown else 0.0


def solve(
    baseline: Baseline, residuals_of: ResidualsOf, catalogue: Sequence[Signature]
) -> tuple[TermSolution, TermSolution]:
    """The likeliest solution of a session, and that in normal noise as it is stated.

    ``residuals_of``: the residuals of the session, with its change since the history, in the noise of a baseline.
    """
    start, quiet = residuals_of(baseline), of_quiet_sensors(baseline)
    solved = partial(solved_in, start, residuals_of, catalogue)
    stated = solved(quiet)
    rivals = [stated]
    for _ in range(FACTORS):
        found = rivals[-1]
        factor = off_by_a_factor(baseline, found.terms)
        if factor is None or is_alike(factor.baseline, found.session.residuals.baseline):
            break
        rivals.append(solved(factor.baseline, factor))
    tailed = [(with_tails(stated.session.residuals.baseline, stated.terms), stated.noisy)]
    tailed += [(with_tails(quiet, stated.terms), ())] if stated.noisy else []
    rivals += [solved(noise.baseline, noise, known) for noise, known in tailed if noise is not None]
    return max(rivals, key=lambda solution: solution.log_evidence), stated


def solved_in(
    start: WhitenedResiduals,
    residuals_of: ResidualsOf,
    catalogue: Sequence[Signature],
    baseline: Baseline,
    noise: OtherNoise | None = None,
    known: Sequence[Noisy] = (),
) -> TermSolution:
    """The likeliest terms in the noise of a baseline; where it is not stated, and of sensors noisier than stated, in
    the noise that they leave. ``known``: sensors whose larger noise the baseline has already."""
    noisy = {n.sensor: n for n in known}
    for _ in range(SEARCHES):
        session = SessionTerms.of(residuals_of(baseline), catalogue, len(noisy))
        solution = TermSolution(session, search(session.model), 0.0)
        noisy |= {n.sensor: n for n in noisy_in(solution)}
        quieter = of_noisy_sensors(baseline, solution.terms)
        if quieter is None and noise is None and baseline.unstated.any():
            quieter = beside(baseline, columns_of(baseline, solution.terms))
        if quieter is not None and is_alike(quieter, baseline):
            quieter = None
        curved = about_effects(quieter or baseline, session.model.start, solution.terms, residuals_of)
        if quieter is None and curved is None:
            break
        baseline = curved or quieter or baseline
    terms = at_their_best(session, solution.terms)
    value = session.model.beside(terms).log_posterior + sum(n.log_prior for n in noisy.values())
    value += FURTHER * max(len(noisy) - 1, 0)
    value += session.model.start.log_scale_free + (0.0 if noise is None else noise.log_prior)
    if session.residuals.baseline is not start.baseline:
        value += log_likelihood_ratio(session.residuals, start)
    return TermSolution(session, terms, value, noise, tuple(noisy.values()))


def is_alike(noise: Baseline, other: Baseline) -> bool:
    """Whether two noises of a session are the same for any purpose."""
    change = np.abs(np.log(np.median(noise.variance / other.variance, axis=0)))
    return bool(change.max() < SETTLED and np.array_equal(noise.unstated, other.unstated))


def noisy_in(solution: TermSolution) -> list[Noisy]:
    """The sensors that are found noisier than stated."""
    unstated = solution.session.residuals.baseline.unstated
    terms = [t for t in solution.terms if t.name == NOISE and not unstated[t.sensors[0]]]
    return [
        Noisy(
            t.sensors[0],
            1 + float(t.variance[0]),
            solution.gained(t),
            t.log_prior,
            solution.course(t),
            float(len(t.variance)),
        )
        for t in terms
    ]


def at_their_best(session: SessionTerms, terms: tuple[Term, ...]) -> tuple[Term, ...]:
    """The terms with their shapes between the points of the grid."""
    for _ in range(ROUNDS):
        for k, term in enumerate(terms):
            if term.named:
                rest = session.model.beside(terms[:k] + terms[k + 1 :])
                terms = (*terms[:k], refined(session.single, rest.info, term), *terms[k + 1 :])
    return terms
