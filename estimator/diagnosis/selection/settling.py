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
up to a spread s, of all sensors of a kind. With δ_i ± σ_i the difference of two sessions whose own courses are left
free,

    δ_i²/(σ_i² + f²o_i²)    and    δ_i²/(σ_i² + s²)

have the median of χ²₁ over the sensors, so that one that changed for good does not widen them: it stands out.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import chdtri

from estimator.causes.contract import Cause, SensorCause, Setting, Shape
from estimator.content import each_remembered
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.between_sessions import deviation
from estimator.diagnosis.residuals.refitted import refitted
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.diagnosis.selection.shared_event import shared_event
from estimator.diagnosis.selection.start import begin
from estimator.least_squares import FAINT, least_squares
from estimator.session import Array
from estimator.significance import p_value

FITS = 0.01
"""p-value of a session's residuals above which no course is looked for: it fits."""
NEGLIGIBLE = 0.01
"""Standard errors of a zero that has settled."""
MEDIAN = float(chdtri(1, 0.5))
SCALE, SQUARE, AXES = [0], [2], [3, 4]
PARTS = (SCALE, SQUARE, AXES)
"""Parameters that have one spread, by their places; what all scale factors have in common is no part of it."""


@dataclass(frozen=True, eq=False)
class Settling:
    """A course that k sensors share in one session."""

    cause: SensorCause
    shapes: tuple[Shape, ...]
    """Of every sensor that follows; the first bears how the whole changes with the nonlinear parameter, if it does."""
    size: Array
    """(k,) β, m/s² (rad/s)."""

    def offset(self, setting: Setting) -> Array:
        """(m,) |o| in a session, m/s² (rad/s)."""
        found, sensors = np.zeros(len(setting.kinds)), [shape.sensors[0] for shape in self.shapes]
        course = self.cause.term(setting, sensors[0], self.shapes[0].nonlinear)[:, 0]
        found[sensors] = np.abs(self.size * (course.mean() if self.cause.since_power_on else np.ptp(course)))
        return found

    def holds_in(self, setting: Setting) -> bool:
        """Whether it shows how far another session had settled."""
        return self.cause.since_power_on and setting.switched_on is not None and self.cause.available(setting)

    def left_free(self, session: Baseline) -> Baseline:
        """Its session fitted with sizes and nonlinear parameter as nuisances of which nothing is known."""
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
    """The same of one session."""
    residuals = WhitenedResiduals.of(session)
    fits = p_value(float(residuals.z @ residuals.z), max(residuals.freedom, 1)) > FITS
    if len(session.unstated) < 2 or (fits and not session.unstated.any()):
        return None
    event = shared_event(begin(session, (), catalogue, patterns=()))
    if not event or not isinstance(event[0].best.cause, SensorCause):
        return None
    traces = [f.best.trace for f in event]
    first = np.cumsum([0, *(t.shape[1] for t in traces[:-1])])
    size = least_squares(np.concatenate(traces, axis=1), residuals.z, FAINT).value[first]
    return Settling(event[0].best.cause, tuple(f.best.shape for f in event), size)


@dataclass(frozen=True, eq=False)
class Comparable:
    """A session as others see it. m sensors."""

    free: Baseline
    """Its own course left free."""
    reach: Array
    """(m,) |o|, m/s² (rad/s), 0 of what has settled."""
    moves: bool
    """Whether it has a course of its own."""

    @classmethod
    def of(cls, session: Baseline, own: Settling | None, known: Sequence[Settling]) -> "Comparable":
        """With its ``own`` course and all that are ``known`` of the unit."""
        offsets = [c.offset(session.setting) for c in known if c is own or c.holds_in(session.setting)]
        reach = np.max([np.zeros(len(session.unstated)), *offsets], axis=0)
        return cls(session if own is None else own.left_free(session), reach, own is not None)

    def opened(self, session: Baseline, settled: "Comparable") -> Baseline:
        """Its ``session`` with how far its parameters may lie off those of one that has settled more."""
        return replace(session, unsettled=np.sqrt(variance_between(self, settled))) if self.reach.any() else session


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
    moved = deviation(p, other.free.parameters, setting.norm)
    noise = np.diagonal(one.free.covariance + other.free.covariance).reshape(moved.shape)
    reach, found = np.maximum(one.reach, other.reach) / setting.norm, np.zeros(moved.shape)
    for kind in set(setting.kinds):
        own = np.array(setting.kinds) == kind
        own_reach = own & (reach > NEGLIGIBLE * np.sqrt(noise[:, 1]))
        if own_reach.any():
            share = typical(moved[own_reach, 1], noise[own_reach, 1], reach[own_reach])
            found[own_reach, 1] = min(share, 1.0) * reach[own_reach] ** 2
        for parts in PARTS if one.moves or other.moves else ():
            about = moved[own][:, parts] - np.median(moved[own][:, parts]) * (parts == SCALE)
            found[np.ix_(own, parts)] = typical(about, noise[own][:, parts], 1.0)
    return found


def typical(moved: Array, noise: Array, size: Array | float) -> float:
    """The variance, in units of ``size`` squared, that changes with the variance ``noise`` have beside it."""
    return max(float(np.median((moved**2 / MEDIAN - noise) / size**2)), 0.0)
