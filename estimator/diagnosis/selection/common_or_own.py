"""Common or own, without a catalogue: a set of names is weighed against an unknown course of the applied vector.

That something acts which the catalogue lacks costs as much as a further name does: one misfortune in a hundred.

Many names, or several of stand and fixture, may stand in for one error of the stand that no cause describes. Where a
free course of the applied vector explains as much, no name is given, but those that hold whatever the applied vector
was: causes that are seen in parity space alone, where no error of stand, fixture or reference shows.
"""

from collections.abc import Callable, Sequence, Set
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import expit

from estimator.calibration.noise import typical, with_the_others
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.likelihood import log_likelihood_ratio
from estimator.diagnosis.residuals.refitted import refitted
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.diagnosis.selection.backward import FURTHER, penalised_log_evidence
from estimator.diagnosis.selection.chosen_together import units
from estimator.diagnosis.selection.excess_noise import sensor_scatter
from estimator.diagnosis.selection.forward import with_structures
from estimator.diagnosis.selection.lack_of_fit import MISFIT
from estimator.diagnosis.selection.search_state import Detection, SearchState
from estimator.diagnosis.selection.shared_event import with_shared_event
from estimator.diagnosis.selection.start import restart_from
from estimator.diagnosis.signatures.applied_course import SIZE, AppliedCourse, applied_course, components
from estimator.diagnosis.signatures.lasting import absorbed_before
from estimator.diagnosis.signatures.scores import rescored, score
from estimator.diagnosis.signatures.traces import Group, Scored
from estimator.session import Array

ROUNDS = 8
"""Steps of the noise in parity space: each halves what is left at least."""


def in_parity_space(start: SearchState, *, size: bool) -> SearchState:
    """The search begun where no applied vector is believed: each row's is free, as in arbitrary orientations.

    The parameters are fitted anew beside the free vectors, so that they too are what parity alone makes of them.
    """
    baseline, setting = start.baseline, start.baseline.setting
    turns = [p.columns for p in components(setting) if size or p.words != SIZE]
    if not turns:
        return replace(start, traces=(), patterns=())
    sigma = np.full((setting.rows, len(turns)), np.inf)
    free = refitted(with_restricted_noise(replace(baseline, row=np.stack(turns, axis=-1), row_sigma=sigma)))
    return restart_from(start, free)


def with_restricted_noise(free: Baseline) -> Baseline:
    """A baseline in parity space with the noise that is not stated estimated there (restricted likelihood).

    The others of a kind are taken to be alike, as everywhere (`calibration.noise`).
    """
    variance, m = free.variance.copy(), len(free.unstated)
    if not free.unstated.any():
        return free
    for _ in range(ROUNDS):
        residuals = WhitenedResiduals.of(replace(free, variance=variance))
        rows = residuals.rows
        of_sensor = residuals.sensor_of_row[:rows] == np.arange(m)[:, None]
        energy, freedom = of_sensor @ residuals.z[:rows] ** 2, of_sensor @ residuals.row_freedom
        value = np.where(free.unstated, variance.mean(axis=0), np.nan)
        expected = typical(value[None], free.unstated[None], free.setting.norm)[0] / variance.mean(axis=0)
        energy, freedom = with_the_others(energy, freedom, expected)
        variance = variance * np.where(free.unstated, energy / np.maximum(freedom, 1.0), 1.0)
    return replace(free, variance=variance)


MOST_LIKELY = 2
"""Different names in one session that are believed without a look at parity space."""


def drop_overfitted_causes(state: SearchState, held_there: Set[Group]) -> SearchState:
    """The state without a crowd of names that parity space does not bear out, where none, a course that sensors share
    being one, explains half of what they do.

    ``held_there``: what holds in parity space.
    """
    if not is_overfitted(state):
        return state
    loose = [f for f in state.detections if f.best.group not in held_there]
    share = [sum(f.best.statistic for f in unit) for unit in units(loose)]
    if len({f.best.cause.identifier for f in loose}) <= MOST_LIKELY or max(share) > 0.5 * sum(share):
        return state
    detections = tuple(f for f in state.detections if f not in loose)
    reduced = with_structures(replace(state, detections=detections, structures=()))
    return reduced if reduced.structures else state


def is_overfitted(state: SearchState) -> bool:
    """Whether more happened than is likely at once: different names, structures, sensors that scatter."""
    names = {f.best.cause.identifier for f in state.detections}
    return len(names) + bool(state.structures) + len(state.scatter_attributed) > MOST_LIKELY


DISTINCT = 5.3
"""ln evidence by which a set of names must beat a course for the course to be no alternative: odds of 200."""

LEAST_FREEDOM = 3.0
"""Degrees of freedom of a sensor's residual from which on the noise that is left can be estimated."""

LEAST = 5.0
"""ln evidence of a course that is believed at all: odds of 150."""

LEAK = 0.025
"""Share of the energy of a common course below which what parity space shows of a sensor may be what is not linear in
the course, or what an unseen change of all scale factors leaves of it."""


def misfit_allowance(state: SearchState) -> float:
    """ln evidence that one name alone may lack: a cause that describes all but a small part is it, though its own
    formula is linear where the stand turned by minutes of arc."""
    alone = len(state.detections) == 1 and not (state.structures or state.scatter)
    return 0.5 * MISFIT * state.detections[0].best.statistic if alone else 0.0


def with_residual_noise(start: SearchState, state: SearchState, unknown: Array) -> tuple[SearchState, SearchState]:
    """The search before any finding, and its result, with the noise of ``unknown`` sensors (m,) bool taken as the
    scatter that the findings leave.

    A noise estimated from residuals that hold an effect hides it, from a course more than from a name. Where no name is
    of what changed since the history, that is left out: parameters are then known so well that minutes of arc are no
    longer linear in it.
    """
    if not (unknown.any() or state.scatter):
        return start, state
    energy, freedom = sensor_scatter(state)
    scale = np.where(freedom >= LEAST_FREEDOM, energy / np.maximum(freedom, 1.0), 1.0)
    variance = np.where(unknown, state.baseline.variance * scale, start.baseline.variance)
    known = replace(start.baseline, variance=variance, unstated=start.baseline.unstated & ~unknown)
    as_stated = not (unknown & ~start.baseline.unstated).any()
    between = any(f.best.cause.between for f in (*state.detections, *state.structures))
    past = (start if as_stated else state).history if between else ()
    begun = restart_from(replace(start, history=past), refitted(known))
    detections, structures = rescored_detections(begun, state.detections), rescored_detections(begun, state.structures)
    seen = replace(begun, detections=detections, structures=structures)
    return begun, replace(seen, excess=state.excess, autocorrelated=state.autocorrelated)


def concerns_all(state: SearchState) -> bool:
    """Whether what was found concerns no sensor in particular, or two sensors or more."""
    places = {f.best.sensors for f in (*state.detections, *state.structures)} | {(s.sensor,) for s in state.scatter}
    return () in places or len(places) > 1


@dataclass(frozen=True, eq=False)
class Ground:
    """The search before any finding, with the noise by which a course is weighed, and the course that explains most
    there.
    """

    begun: SearchState
    noise: float
    """ln evidence of that noise against what is stated."""
    course: AppliedCourse

    @property
    def log_evidence(self) -> float:
        """ln evidence of the course in that noise against no effect in the noise as stated."""
        return self.course.log_evidence + self.noise


def likeliest_ground(begun: SearchState, plain: SearchState, noise: float) -> Ground:
    """A course may act beside the scatter that was found, as in ``begun``, or explain it, in the noise as stated."""
    joint = Ground(begun, noise, likeliest_course(begun, ()))
    return joint if begun is plain else max(joint, Ground(plain, 0.0, likeliest_course(plain, ())), key=_evidence)


def _evidence(ground: Ground) -> float:
    return ground.log_evidence


def log_evidence_of_noise(state: SearchState, begun: SearchState, plain: SearchState) -> float:
    """ln evidence of scatter beyond what is stated, of sensors' own courses in it, every sensor paid for as a name.

    ``begun``, ``plain``: nothing found, in the noise that was found and as stated.
    """
    _, freedom = sensor_scatter(state)
    larger = log_likelihood_ratio(begun.residuals, plain.residuals) if begun is not plain else 0.0
    courses = sum(s.log_evidence for s in state.autocorrelated)
    sizes = sum(0.5 * np.log(max(freedom[i], 2.0) / 2) + np.log(state.sensor_count) for i in state.scatter_attributed)
    return float(larger + courses - sizes) - FURTHER * len(state.scatter_attributed)


def with_events(start: SearchState, state: SearchState) -> SearchState:
    """The state, or its rival in which several sensors share one event, whichever is likelier."""
    return with_shared_event(start, state, log_evidence_of_sensors)


def log_evidence_of_sensors(start: SearchState, state: SearchState) -> float:
    """ln evidence of what was found, scatter beyond the stated noise included, against nothing; ``start``: nothing
    found, in the noise by which all that is compared is weighed.

    Where noise is not known it is what the findings leave: what explains more also leaves less of it.
    """
    begun, seen = with_residual_noise(start, state, state.baseline.unstated)
    same = begun.history == start.history
    plain = start if same else restart_from(replace(start, history=begun.history), start.baseline)
    return penalised_log_evidence(seen) + log_evidence_of_noise(state, begun, plain)


def with_likelier_vector_course(
    start: SearchState, state: SearchState, search: Callable[[SearchState], SearchState]
) -> SearchState:
    """The state, or its rival with a course of the applied vector, whichever is likelier; ``start``: nothing found."""
    if not concerns_all(state):
        return state
    begun, seen = with_residual_noise(start, state, state.baseline.unstated)
    plain = with_residual_noise(start, state, start.baseline.unstated)[0] if state.scatter else begun
    noise = log_evidence_of_noise(state, begun, plain)
    ground = likeliest_ground(begun, plain, noise)
    evidence = penalised_log_evidence(seen) + misfit_allowance(seen) + noise
    if ground.log_evidence - FURTHER - evidence < -DISTINCT and not is_overfitted(state):
        return state
    rival = with_free_vector(start, ground.begun, ground.course, search)
    gained = rival.log_evidence + ground.noise - FURTHER - evidence
    if gained > 0 and rival.course.log_evidence > LEAST:
        return without_leaks(replace(rival.parity, courses=(rival.course,)))
    held_there = {f.best.group for f in rival.parity.detections}
    return with_doubt(drop_overfitted_causes(state, held_there), held_there, float(expit(gained)))


def without_leaks(state: SearchState) -> SearchState:
    """The state without names so small beside the common course that they may be what is not linear in it."""
    common = 2 * LEAK * sum(c.log_evidence for c in state.courses)
    small = tuple(f for f in state.detections if f.best.statistic < common)
    detections = tuple(f for f in state.detections if f not in small)
    return replace(state, detections=detections, structures=(*state.structures, *small))


@dataclass(frozen=True, eq=False)
class SharedRival:
    """A course of the applied vector, and what holds whatever that vector was."""

    course: AppliedCourse
    parity: SearchState
    log_evidence: float
    """ln evidence of both together."""


def with_free_vector(
    start: SearchState, begun: SearchState, course: AppliedCourse, search: Callable[[SearchState], SearchState]
) -> SharedRival:
    """The course with the causes that parity space shows beside it; its size is free only where that explains more.

    ``begun``: the search of ``start`` with the noise by which both are weighed.
    """
    parity = search(in_parity_space(start, size=False))
    supported = rescored_detections(begun, parity.detections)
    joint = likeliest_course(begun, supported)
    paid = joint.log_evidence + penalised_log_evidence(replace(begun, detections=supported)) - FURTHER * bool(supported)
    if supported and paid > course.log_evidence:
        return SharedRival(joint, parity, paid)
    if supported and SIZE in course.components:
        parity = search(in_parity_space(start, size=True))
    return SharedRival(course, parity, course.log_evidence)


def with_doubt(state: SearchState, held_there: Set[Group], doubt: float) -> SearchState:
    """The state with the probability that a course acts instead beside every name that parity does not bear out."""
    detections = [
        f if f.best.group in held_there else replace(f, unnamed=max(f.unnamed, doubt)) for f in state.detections
    ]
    return replace(state, detections=tuple(detections))


def likeliest_course(start: SearchState, detections: Sequence[Detection]) -> AppliedCourse:
    """The course of the applied vector beside findings, lasting since the history or new."""
    attributed = replace(start, detections=tuple(detections)).attributed()
    lasting = (False, True) if start.history else (False,)
    tried = [applied_course(start.residuals, attributed, lasting=k) for k in lasting]
    return max(tried, key=lambda c: c.log_evidence)


def rescored_detections(start: SearchState, detections: Sequence[Detection]) -> tuple[Detection, ...]:
    """Findings of another search as the residuals of ``start`` show them, those that show there at all."""
    nothing = np.zeros((len(start.residuals.z), 0))
    seen = []
    for old in detections:
        known = (*start.traces, *start.patterns)
        candidates = [t.at(old.best.sensors) for t in known if t.cause is old.best.cause]
        same = [s for s in score(start.residuals, candidates, nothing) if s.shape.nonlinear == old.best.shape.nonlinear]
        if same:
            best = max(same, key=lambda s: s.log_evidence)
        elif old.best.shape.nonlinear:
            best = rescored(start.residuals, traced(start, old.best), nothing)
        else:
            continue
        seen.append(replace(old, best=sharing(best, old.best.places) if old.event else best))
    return tuple(seen)


def traced(start: SearchState, old: Scored) -> Scored:
    """A shape between the points of the grid with what the residuals of ``start`` show of it."""
    columns = old.shape.columns
    width = len(old.cause.units) or columns.shape[-1]  # a mere pattern names no unit
    before = absorbed_before(start.residuals, old.cause, [old.shape.first(width)]) if old.lasting else 0.0
    own = start.residuals.trace(columns[..., :width], before)
    if columns.shape[-1] == width:
        return replace(old, trace=own)
    return replace(old, trace=np.concatenate([own, start.residuals.trace(columns[..., width:])], axis=1))


def sharing(best: Scored, places: int) -> Scored:
    """The score of a sensor's part in an event, which is chosen among other ``places`` than a cause of one sensor."""
    log_evidence = best.log_evidence + float(np.log(best.places / places))
    return replace(best, places=places, log_evidence=log_evidence)
