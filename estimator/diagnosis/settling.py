"""A block that settles: how far its parameters may lie off those that its other sessions find.

A course that sensors share moves their zeros during a session, and with them what a calibration finds of each: against
sessions that lack the course every sensor has changed, by a size of its own and from the one cause. The board that
warms moves scale factors and axes too.

Theory
------
With h(t; ψ) the course and β_i its sizes, a session finds b_i + o_i of a zero, o_i = β_i·mean h. Where h → 0, as after
switching on, b_i is what other sessions find; else o_i is as large as what is seen of it. Time constant and sizes
found in one session hold for others, where these say when the unit was switched on. Real courses are not quite of their
formula, and boards not quite of one course: b_i repeats up to a share f ≤ 1 of o_i; scale factor, square term and axis
up to a spread s, of all sensors of a kind. With d (5m,) the difference of the parameters of two sessions whose own
courses are left free, and C its covariance, which is far from diagonal (a course is much like a scale factor or a turn
where the head turns with time),

    d ~ N(0, C + V),   V = diag(f²o_i²) of zeros and diag(s²) of the others

and f² and each s² are the likeliest, by steps v ← v·√(d'Q P Q d / tr(Q P)), Q = (C + V)⁻¹, P the place of each. A turn
or a scale that all sensors of a kind have in common is no part of it. One sensor that changed for good would pass for a
wide V: those that the others make out to have changed are left out.

Time constant and sizes are those of the session's rows and its history together: a zero that is known beforehand is
where its course ends. A course of hundreds of standard errors also moves a fit by more than is linear, so the session
is fitted with the course taken off, which is then put back as the effect that it is.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from estimator.causes.contract import Cause, SensorCause, Setting, Shape, Signature
from estimator.content import each_remembered
from estimator.diagnosis.posterior.explained import begin
from estimator.diagnosis.posterior.free_shared import FreeShared
from estimator.diagnosis.posterior.information import InputInformation
from estimator.diagnosis.posterior.refine import bent
from estimator.diagnosis.posterior.search import climbed
from estimator.diagnosis.posterior.sensor_causes import SensorCauses
from estimator.diagnosis.posterior.shared_causes import SharedCauses
from estimator.diagnosis.posterior.solve import SessionTerms, at_their_best, solve
from estimator.diagnosis.posterior.term import Term
from estimator.diagnosis.posterior.write import scored
from estimator.diagnosis.residuals.baseline import Baseline, turn_response
from estimator.diagnosis.residuals.between_sessions import parameter_change
from estimator.diagnosis.residuals.common_start import baselines
from estimator.diagnosis.residuals.fitted import baseline_of, readings_without
from estimator.diagnosis.residuals.refitted import refitted
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.least_squares import FAINT, least_squares
from estimator.session import Array, CalibrationSession
from estimator.significance import p_value

FITS = 0.01
"""p-value of a session's residuals above which no course is looked for: it fits."""
NEGLIGIBLE = 0.01
"""Standard errors of a zero that has settled."""
CHANGED = 1e-3
"""p-value of a sensor by the others, any of them, below which it has changed for good."""
SUSPECTS = 3
"""Sensors, by either measure, of which it is asked whether they have changed."""
STEPS = 25
"""Steps for the multiples: each reduces a multiple that should be zero to a half or less."""
SCALE, ZERO, SQUARE, AXES = [0], [1], [2], [3, 4]
PARTS = (SCALE, SQUARE, AXES)
"""Parameters that have one spread, by their places; what all scale factors have in common is no part of it."""


@dataclass(frozen=True, eq=False)
class Settling:
    """A course that k sensors share in one session."""

    cause: SensorCause
    shapes: tuple[Shape, ...]
    """Shapes of every sensor that follows; the first has the derivative by the nonlinear parameter, if there is one."""
    size: Array
    """(k,) β, m/s² (rad/s)."""

    def offset(self, setting: Setting) -> Array:
        """(m,) |o| in a session, m/s² (rad/s)."""
        found, sensors = np.zeros(len(setting.kinds)), [shape.sensors[0] for shape in self.shapes]
        course = self.cause.term(setting, sensors[0], self.shapes[0].nonlinear)[:, 0]
        found[sensors] = np.abs(self.size * (course.mean() if self.cause.since_power_on else np.ptp(course)))
        return found

    def beside(self, session: CalibrationSession, history: Sequence[Baseline]) -> tuple[Baseline, list[Baseline]]:
        """The course's session and the earlier ones, fitted by `baselines`; the course is taken out of the session
        before the fit and put back into its residuals: a course of hundreds of standard errors moves a fit by more than
        is linear.
        """
        columns = [shape.columns[..., 0] * size for shape, size in zip(self.shapes, self.size, strict=True)]
        effect = np.sum(columns, axis=0)
        scale = baseline_of(session).parameters.scale
        without = baseline_of(replace(session, readings=readings_without(session, scale, effect)))
        fitted, earlier = baselines(without, history)
        whole = replace(fitted.session, readings=session.readings)
        return replace(fitted, session=whole, residual=fitted.residual + effect, course=effect), earlier

    def holds_in(self, setting: Setting) -> bool:
        """Whether it shows how far another session had settled."""
        return self.cause.since_power_on and setting.switched_on is not None and self.cause.available(setting)

    def left_free(self, session: Baseline) -> Baseline:
        """The course's session fitted with sizes and nonlinear parameter as nuisances of which nothing is known."""
        columns = np.concatenate([s.columns for s in self.shapes], axis=-1)
        columns = columns / np.sqrt((columns**2).sum(axis=(0, 1)))
        constant = np.concatenate([session.constant, columns], axis=-1)
        unknown = np.concatenate([session.constant_sigma, np.full(columns.shape[-1], np.inf)])
        return refitted(replace(session, constant=constant, constant_sigma=unknown))


@each_remembered
def settling(sessions: list[Baseline], catalogue: tuple[Cause, ...]) -> list[Settling | None]:
    """The course that sensors share in every earlier session by itself; None where there is none."""
    return [settling_in(session, catalogue) for session in sessions]


def settling_in(session: Baseline, catalogue: tuple[Cause, ...]) -> Settling | None:
    """The shared course of one session by itself; None where there is none."""
    residuals = WhitenedResiduals.of(session)
    fits = p_value(float(residuals.z @ residuals.z), max(residuals.freedom, 1)) > FITS
    if len(session.unstated) < 2 or (fits and not session.unstated.any()):
        return None
    signatures = [c for c in catalogue if isinstance(c, Signature)]
    if not may_share(residuals, signatures):
        return None
    solution, _ = solve(session, WhitenedResiduals.of, signatures)
    term = shared_in(solution.terms)
    return None if term is None else of_term(solution.session, solution.terms, term, ())


def may_share(residuals: WhitenedResiduals, catalogue: Sequence[Signature]) -> bool:
    """Whether a course that sensors share explains anything in a session, were it the only thing that acts."""
    info, _ = InputInformation.of(residuals)
    shared = SharedCauses(SensorCauses(residuals, [c for c in catalogue if c.shared_sentence]))
    return any(c.value > 0 for kind in (shared, FreeShared(residuals)) for c in kind.candidates(info))


def shared_in(terms: Sequence[Term]) -> Term | None:
    """The course that most sensors share; None where there is none."""
    several = [t for t in terms if t.named and len(t.sensors) > 1]
    return max(several, key=lambda t: len(t.sensors), default=None)


def of_term(session: SessionTerms, terms: Sequence[Term], term: Term, beside: Sequence[Term]) -> Settling:
    """A shared term as a course, with the sizes that the residuals show ``beside`` other terms."""
    assert term.effect is not None
    cause = term.effect.cause
    assert isinstance(cause, SensorCause)
    info = session.model.beside(tuple(t for t in terms if t is not term)).info
    members = scored(session, info, term, bent(session.single, info, term))
    traces = [s.trace for s in members] + [session.T @ t.columns for t in beside]
    first = np.cumsum([0, *(t.shape[1] for t in traces[: len(members) - 1])])
    size = least_squares(np.concatenate(traces, axis=1), session.residuals.z, FAINT).value[first]
    return Settling(cause, tuple(s.shape for s in members), size)


def beside_history(
    own: Settling, session: Baseline, history: Sequence[Baseline], catalogue: tuple[Cause, ...]
) -> Settling:
    """The course of a session as its own rows and its history show it together: what the history knows of a zero is
    known of where the course ends."""
    causes = [own.cause, *(c for c in catalogue if isinstance(c, Signature) and c.moves_parameters)]
    terms_of = SessionTerms.of_causes(begin(session, history, causes).residuals, causes)
    terms = at_their_best(terms_of, climbed(terms_of.model, terms_of.model.kinds))
    term = shared_in([t for t in terms if t.effect is not None and t.effect.cause is own.cause])
    if term is None or not {i for shape in own.shapes for i in shape.sensors} <= set(term.sensors):
        return own
    return of_term(terms_of, terms, term, [t for t in terms if t is not term])


@dataclass(frozen=True, eq=False)
class Comparable:
    """A session as others see it. m sensors."""

    free: Baseline
    """The session with its own course left free."""
    reach: Array
    """(m,) |o|, m/s² (rad/s), 0 of what has settled."""
    moves: bool
    """Whether it has a course of its own."""

    @classmethod
    def of(cls, session: Baseline, own: Settling | None, known: Sequence[Settling]) -> "Comparable":
        """The session with its ``own`` course and all that are ``known`` of the unit."""
        offsets = [c.offset(session.setting) for c in known if c is own or c.holds_in(session.setting)]
        reach = np.max([np.zeros(len(session.unstated)), *offsets], axis=0)
        return cls(session if own is None else own.left_free(session), reach, own is not None)

    @property
    def has_settled(self) -> bool:
        """Whether no course moves its zeros."""
        sigma = np.sqrt(np.diagonal(self.free.covariance)[ZERO[0] :: 5]) * self.free.setting.norm
        return not (self.moves or (self.reach > NEGLIGIBLE * sigma).any())

    def opened(self, session: Baseline, settled: "Comparable") -> Baseline:
        """The ``session`` with the spread of its parameters about those of one that has settled more."""
        return session if self.has_settled else replace(session, unsettled=np.sqrt(variance_between(self, settled)))


def with_open_change(
    now: Baseline, history: Sequence[Baseline], courses: Sequence[Settling | None]
) -> tuple[Baseline, list[Baseline]]:
    """A session and its history, each with how far its parameters may lie off; ``courses`` of them, the session's
    first. Those of earlier sessions are left free."""
    sessions = [now, *history]
    alike = [k for k, s in enumerate(sessions) if s.setting.kinds == now.setting.kinds]
    known = [course for k in alike if (course := courses[k]) is not None]
    if not known or len(alike) < 2:
        return now, list(history)
    seen = {k: Comparable.of(sessions[k], courses[k], known) for k in alike}
    earlier = [seen[k].opened(seen[k].free, seen[0]) if k in seen else s for k, s in enumerate(sessions)][1:]
    settled = min((seen[k] for k in reversed(alike) if k), key=lambda one: float(one.reach.sum()))
    return seen[0].opened(now, settled), earlier


def variance_between(one: Comparable, other: Comparable) -> Array:
    """(m, 5) dimensionless: of how parameters of two sessions lie apart beyond their noise, each kind by itself."""
    p, setting = one.free.parameters, one.free.setting
    sigma = np.sqrt(np.diagonal(one.free.covariance + other.free.covariance)).reshape(-1, 5)
    reach, kinds = np.maximum(one.reach, other.reach) / setting.norm, np.array(setting.kinds)
    common, parts = [turn_response(p)], list[Array]()
    for kind in dict.fromkeys(setting.kinds):
        of_kind = kinds == kind
        parts.append(at_places(np.where(of_kind & (reach > NEGLIGIBLE * sigma[:, 1]), reach, 0.0), ZERO))
        parts += [at_places(1.0 * of_kind, places) for places in (PARTS if one.moves or other.moves else ())]
        common.append(at_places(1.0 * of_kind, SCALE).reshape(-1, 1))
    change = parameter_change(one.free, [other.free])
    shown = [part.ravel() / sigma.ravel() for part in parts if part.any()]
    if change is None or not shown:
        return np.zeros(sigma.shape)
    root = change.inverse_root * sigma.ravel()
    known = Difference(root.T @ root, root.T @ change.deviation)
    found = spread(known.without(np.concatenate(common, axis=1) / sigma.reshape(-1, 1)), np.array(shown) ** 2)
    return np.asarray(found.reshape(sigma.shape) * sigma**2)


def at_places(value: Array, places: Sequence[int]) -> Array:
    """(m, 5) array that holds every sensor's ``value`` (m,) in some places and zero in the others."""
    found = np.zeros((len(value), 5))
    found[:, places] = value[:, None]
    return found


@dataclass(frozen=True, eq=False)
class Difference:
    """Difference between the parameters of two sessions, P of them in standard errors."""

    information: Array
    """(P, P) information of its noise; none along directions that neither session sees."""
    score: Array
    """(P,) information times difference."""

    def without(self, directions: Array) -> "Difference":
        """The difference with everything along ``directions`` (P, k) taken as unknown."""
        along = self.information @ directions
        kept = along @ np.linalg.pinv(directions.T @ along, hermitian=True)
        return Difference(self.information - kept @ along.T, self.score - kept @ (directions.T @ self.score))

    def beyond(self, variance: Array) -> "Difference":
        """The difference where it varies by a ``variance`` (P,) more."""
        more = np.eye(len(variance)) + self.information * variance
        both = np.linalg.solve(more, np.column_stack([self.information, self.score]))
        return Difference(both[:, :-1], both[:, -1])

    def multiples(self, parts: Array) -> Array:
        """(k,) the likeliest of ``parts`` (k, P) of a variance, by steps that only make them likelier (Hunter & Lange,
        The American Statistician 58, 2004)."""
        value = 1e4 / parts.max(axis=1)
        for _ in range(STEPS):
            beyond = self.beyond(value @ parts)
            size = parts @ np.diagonal(beyond.information)
            value = value * np.sqrt(parts @ beyond.score**2 / np.where(size > 0, size, np.inf))
        return value

    def of_sensors(self) -> Array:
        """(m,) χ² of every sensor's five parameters, given the others'."""
        m, score = len(self.score) // 5, self.score.reshape(-1, 5)
        blocks = self.information.reshape(m, 5, m, 5)[np.arange(m), :, np.arange(m)]
        return np.asarray((score[:, None, :] @ np.linalg.pinv(blocks, hermitian=True) @ score[..., None])[:, 0, 0])


def spread(known: Difference, parts: Array) -> Array:
    """(P,) the likeliest sum of multiples of ``parts`` (k, P) by which parameters vary beyond their noise.

    A sensor that has changed for good by what the others show takes no part.
    """
    m, others, left = len(known.score) // 5, known, list(range(len(known.score) // 5))
    found = known.multiples(parts) @ parts
    while len(left) > (m + 1) // 2:
        as_noisy, as_varied = known.of_sensors(), known.beyond(found).of_sensors()
        suspects = dict.fromkeys(
            i for each in (as_noisy, as_varied) for i in sorted(left, key=lambda i: -each[i])[:SUSPECTS]
        )
        tried = []
        for i in suspects:
            rest = others.without(np.eye(5 * m)[:, 5 * i : 5 * i + 5])
            again = rest.multiples(parts) @ parts
            tried.append((float(known.beyond(again).of_sensors()[i]), i, rest, again))
        distance, worst, rest, again = max(tried, key=lambda one: one[0])
        if p_value(distance, 5) * m > CHANGED:
            break
        left.remove(worst)
        others, found = rest, again
    return found
