"""The posterior as the state that findings are written from."""

from dataclasses import replace

import numpy as np
from scipy.special import logsumexp

from estimator.causes.contract import CommonCause, SensorCause, Shape, Signature
from estimator.diagnosis.posterior.explained import (
    AppliedCourse,
    Autocorrelation,
    Detection,
    ExcessVariance,
    ExplainedSession,
    Scored,
    restart_from,
)
from estimator.diagnosis.posterior.information import InputInformation
from estimator.diagnosis.posterior.moved_parameters import OwnChange
from estimator.diagnosis.posterior.priors import CREDIBLE
from estimator.diagnosis.posterior.refine import bent
from estimator.diagnosis.posterior.solve import Noisy, SessionTerms, TermSolution, solve
from estimator.diagnosis.posterior.term import COURSE, CauseEffect, Since, Term
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.session import Array
from estimator.significance import p_value

SHOWN = 12
"""Rivals of a name that are kept."""

SURE = 100.0
"""Odds of a shape that sensors share over one of each from which on it is said for sure."""

FOLLOWS = 4.0
"""Standard errors below which a sensor that shares a course is counted, and not named."""


def posterior(start: ExplainedSession) -> ExplainedSession:
    """The state of a session in which nothing was sought yet, with what the posterior holds."""

    def residuals_of(baseline: Baseline) -> WhitenedResiduals:
        return start.residuals if baseline is start.baseline else restart_from(start, baseline).residuals

    if start.residuals.freedom < 1:
        return start  # every reading serves to estimate something
    catalogue = [c for c in start.catalogue if isinstance(c, Signature)]
    best, stated = solve(start.baseline, residuals_of, catalogue)
    state = written(start, best)
    if best.noise is None:
        return state
    names = {f.best.group for f in state.detections}
    lost = [f for f in written(start, stated).detections if f.best.group not in names] if best.noise.tails else []
    return replace(state, noise_claims=best.noise.claims, in_tails=tuple(lost))


def written(start: ExplainedSession, solution: TermSolution) -> ExplainedSession:
    """A solution as findings are written from it."""
    causes = [t for t in solution.terms if t.named]
    changes = [t for t in solution.terms if t.effect is not None and not t.named]
    courses = [t for t in solution.terms if t.name == COURSE]
    return replace(
        start,
        residuals=solution.session.residuals,
        of_causes=(solution.session.single, solution.session.common),
        detections=tuple(d for t in causes for d in detections(solution, t)),
        structures=tuple(d for t in changes for d in detections(solution, t)),
        excess=tuple(map(excess_of, solution.noisy)),
        autocorrelated=tuple(Autocorrelation(i, order_of(t), solution.gained(t)) for t in courses for i in t.sensors),
        courses=tuple(applied(solution, t) for t in courses if not t.sensors),
    )


def order_of(term: Term) -> str:
    """The order of the rows along which a course runs."""
    assert term.course is not None
    return term.course.order


def detections(solution: TermSolution, term: Term) -> list[Detection]:
    """A term with its rivals: one detection, or one of every sensor that shares it."""
    session, rest, near = solution.session, solution.without(term), solution.rivals(term)
    total = float(logsumexp([c.value for c in near] + [0.0]))
    own = next((c.value for c in near if c.place == term.place), 0.0)
    others = sorted((c for c in near if c.named and c.place != term.place), key=lambda c: -c.value)[:SHOWN]
    ranked = [(scored(session, rest.info, c.term())[0], c.value) for c in others]
    members = scored(session, rest.info, term, bent(session.single, rest.info, term))
    several = len(members) > 1
    doubt = several and session.shared.log_own_shapes(rest.info, term) > -np.log(SURE)
    return [
        Detection(
            best=best,
            p_family=float(np.exp(-total)),
            ranking=tuple(sorted([(best, own), *ranked], key=lambda pair: -pair[1])),
            unnamed=solution.course(term) if term.named else 0.0,
            event=term.sensors if several else (),
            follows=several and best.statistic < FOLLOWS**2,
            shape_in_doubt=bool(doubt),
        )
        for best in members
    ]


def scored(session: SessionTerms, info: InputInformation, term: Term, moved: Array | None = None) -> list[Scored]:
    """A term as findings are written from it: one, or one of every sensor that shares it.

    ``info`` beside the others; ``moved`` (D,) change of the whole effect with its shape,
    which is then left free: it is the first one's.
    """
    effect, q = term.effect, term.columns.shape[1]
    assert effect is not None
    if len(term.sensors) < 2:
        members = [one(session, info, term, term.sensors, slice(0, q), effect.scale)]
    else:
        members = [
            one(session, info, term, (i,), slice(k, k + 1), effect.scale[k : k + 1]) for k, i in enumerate(term.sensors)
        ]
    if moved is not None:
        members[0] = with_free_shape(session, members[0], moved)
    return members


def one(
    session: SessionTerms,
    info: InputInformation,
    term: Term,
    sensors: tuple[int, ...],
    own: slice,
    scale: Array,
) -> Scored:
    """The columns ``own`` of a term as those of some sensors, of amplitudes in the cause's SI unit."""
    effect, W = term.effect, term.columns[:, own]
    assert effect is not None
    columns = columns_of(session, effect, sensors)
    beside = np.zeros((*columns.shape[:2], W.shape[1] - len(scale)))
    gram, along = W.T @ info.A @ W, W.T @ info.a
    statistic = max(float(along @ np.linalg.pinv(gram, hermitian=True, rcond=1e-9) @ along), 0.0)
    trace = session.T @ W / np.concatenate([scale, np.ones(beside.shape[-1])])
    shape = Shape(sensors, np.concatenate([columns, beside], axis=-1), effect.nonlinear)
    q = W.shape[1]
    return Scored(effect.cause, shape, lasts(session, effect), trace, statistic, tail(statistic, q))


def tail(statistic: float, q: int) -> float:
    """p-value of χ² with q degrees of freedom."""
    return float(p_value(statistic, q))


def lasts(session: SessionTerms, effect: CauseEffect) -> bool:
    """Whether an effect is taken as having acted before the history; without one nothing speaks against it."""
    without_history = session.residuals.change is None and not effect.cause.between
    return effect.since is Since.BEFORE or without_history


def columns_of(session: SessionTerms, effect: CauseEffect, sensors: tuple[int, ...]) -> Array:
    """(R, m, q) m/s² (rad/s) per unit of each amplitude in the cause's SI unit."""
    cause, setting = effect.cause, session.residuals.baseline.setting
    if isinstance(cause, SensorCause):
        return cause.placed(setting, sensors[0], effect.nonlinear)
    if isinstance(cause, CommonCause):
        return setting.through(cause.change(setting))
    assert isinstance(cause, OwnChange)
    whole = cause.columns(setting, Shape(sensors, np.zeros(0), effect.nonlinear))
    return np.asarray(whole[..., cause.moves[int(effect.nonlinear[0])]])


def with_free_shape(session: SessionTerms, first: Scored, moved: Array) -> Scored:
    """One that has the change (D,) of the whole effect with its shape appended to its own columns."""
    layout, at = session.single.layout, len(first.cause.units)
    free = moved[: layout.R * layout.m].reshape(layout.R, layout.m, 1)
    columns, trace = first.shape.columns, first.trace
    shape = replace(first.shape, columns=np.concatenate([columns[..., :at], free, columns[..., at:]], axis=-1))
    return replace(
        first, shape=shape, trace=np.concatenate([trace[:, :at], (session.T @ moved)[:, None], trace[:, at:]], axis=1)
    )


def excess_of(noisy: Noisy) -> ExcessVariance:
    """A sensor noisier than stated."""
    chance = float(np.exp(-max(noisy.log_evidence + noisy.log_prior, 0.0)))
    return ExcessVariance(
        noisy.sensor, noisy.ratio, noisy.freedom, noisy.log_evidence, chance, doubtful=noisy.course > 1 - CREDIBLE
    )


def applied(solution: TermSolution, term: Term) -> AppliedCourse:
    """The likeliest course of the applied vector."""
    known, W, info = term.course, term.columns, solution.without(term).info
    assert known is not None
    assert known.lift is not None
    u = np.linalg.solve(np.diag(1 / term.variance) + W.T @ info.A @ W, W.T @ info.a)
    return AppliedCourse(solution.gained(term), known.order, known.components, (known.lift @ u).T)
