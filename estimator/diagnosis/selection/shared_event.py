"""One event that several sensors show: a shape that they share, and a size of each.

A bump, a break of the supply or a block seated anew moves the zeros of many sensors at one moment. Sensor by sensor
that is as many misfortunes as sensors, which no session has; it is one, and is weighed as one.

Theory
------
The event adds k_i·h(r; ψ) at the input of every sensor i of a set S, with one ψ. Let X(ψ) be the whitened traces of the
sensors side by side, what the calibration absorbs projected out, and X̂ an orthonormal basis of them: T = |X̂'z|² is χ²
without the event, with as many degrees of freedom as sensors (the traces of sensors overlap where a row's β error or an
unknown direction is common to them). ψ is where T of all sensors is largest, of the n_ψ that are tried. There a sensor
belongs to the event by what the others leave: with k of m sensors in, of mean square size g, a further one with T_i
joins by the odds

    (k + 1)/(m − k) · exp(½·T_i·g/(1 + g))/√(1 + g)          (rule of succession; amplitude ~ N(0, g))

The event is weighed as one finding against what was found sensor by sensor, and against a free course of every sensor.
Any cause may be shared: those with a sentence for it (`Cause.shared_sentence`) can be named, the others are rivals.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import comb

import numpy as np
from scipy.special import chdtrc

from estimator.arrays import eigh
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.diagnosis.selection.backward import FURTHER, backward_elimination
from estimator.diagnosis.selection.forward import forward_selection, with_structures
from estimator.diagnosis.selection.ranking import extended_basis, scores_given
from estimator.diagnosis.selection.search_state import LEVEL, Found, SearchState
from estimator.diagnosis.signatures.autocorrelation import autocorrelation
from estimator.diagnosis.signatures.scores import bayes_factor, rescored
from estimator.diagnosis.signatures.traces import INVISIBLE, Scored, Traces
from estimator.session import Array

SURE = float(np.log(19))
"""ln odds by which a sensor joins an event: one in twenty that joined last is a bystander. Known to fail beside a jump
of eighty standard errors, where another sensor seems to have one of four: the turns of the block are not linear."""

SCREEN = 0.01
"""p-value of the best moment, all moments together, below which it is looked at closely; it names nothing."""

CLOSEST = 3
"""Moments that are looked at closely: next to the best one others may explain almost as much."""

OVERLAP = 1e-4
"""Least eigenvalue of the correlation of traces that counts as a direction: below it amplitudes would cancel."""

ONE_ROW = 0.5
"""Share of a shape's energy that one row may hold: more is something that befell the row."""


@dataclass(frozen=True, eq=False)
class Course:
    """A cause's shapes with one nonlinear parameter, one shape a sensor."""

    traces: Traces
    numbers: tuple[int, ...]
    """Of the shapes, in the order of the sensors."""

    def on(self, sensors: Sequence[int]) -> "Course":
        """Those of some sensors."""
        return self.of([k for k in self.numbers if self.traces.sensor[k] in sensors])

    def of(self, numbers: Sequence[int]) -> "Course":
        """Those of some numbers."""
        return Course(self.traces, tuple(numbers))

    def scored(self, k: int, places: int = 1) -> Scored:
        """The shape of one number, still to be scored."""
        shape, trace = self.traces.whole(k)
        return Scored(self.traces.cause, shape, self.traces.lasting[k], trace, 0.0, 0, 0.0, 1.0, places)


def with_shared_event(
    start: SearchState, state: SearchState, log_evidence: Callable[[SearchState, SearchState], float]
) -> SearchState:
    """The state, or its rival with one event that sensors share and what is found beside it, whichever is likelier.

    ``start``: nothing found; ``log_evidence`` of a state against ``start``.
    """
    event = shared_event(start)
    if not event:
        return state
    rival = beside(start, event)
    is_likelier = rival is not None and log_evidence(start, rival) > log_evidence(start, state)
    return rival if rival is not None and is_likelier else state


def beside(start: SearchState, event: tuple[Found, ...]) -> SearchState | None:
    """What is found beside an event; None where the search takes it for noise."""
    state = forward_selection(replace(start, found=event))
    if not any(f.event for f in state.found):
        return None
    return backward_elimination(with_structures(state))


def shared_event(start: SearchState) -> tuple[Found, ...]:
    """The most likely event, its sensors the strongest first; empty where there is none."""
    own = [t for t in start.traces if t.cause.shared_sentence and t.beside is None]
    every = [course for traces in own for course in courses(start.residuals, traces)]
    if not every:
        return ()
    energy, freedom = energies(start.residuals, every)
    best = np.argsort(-bayes_factor(energy, freedom), kind="stable")[:CLOSEST]
    if chdtrc(freedom[best[0]], energy[best[0]]) * len(every) > SCREEN:
        return ()
    tried = [joined(start, every[k], len(every)) for k in best]
    event = max(tried, key=whole_log_evidence)
    if len(event) < 2 or family_p_value(start, event) >= LEVEL or courses_explain_more(start, event):
        return ()
    return ranked(start, event)


def courses(residuals: WhitenedResiduals, traces: Traces) -> list[Course]:
    """A cause's shapes by their nonlinear parameters, where two sensors or more show them in more rows than one."""
    rows, m = residuals.baseline.residual.size, len(residuals.baseline.unstated)
    square = np.einsum("snq,snq->sn", traces.columns[:, :rows], traces.columns[:, :rows])
    shown = np.sqrt(square.sum(axis=1)) > INVISIBLE * np.linalg.norm(traces.raw, axis=1)
    of_row = square.reshape(len(square), -1, m).sum(axis=2)
    shown &= of_row.max(axis=1) < ONE_ROW * of_row.sum(axis=1)
    grouped: dict[tuple[float, ...], list[int]] = {}
    for k in np.flatnonzero(shown & (traces.sensor >= 0)).tolist():
        grouped.setdefault(traces.shapes[k].nonlinear, []).append(k)
    return [Course(traces, tuple(numbers)) for numbers in grouped.values() if len(numbers) > 1]


def energies(residuals: WhitenedResiduals, every: Sequence[Course]) -> tuple[Array, Array]:
    """(C,) T and (C,) int its degrees of freedom of courses, each with a size of every sensor."""
    found = [energy_of(residuals, course) for course in every]
    return np.array([energy for energy, _ in found]), np.array([freedom for _, freedom in found])


def energy_of(residuals: WhitenedResiduals, course: Course) -> tuple[float, int]:
    """T and its degrees of freedom of one course."""
    unit = unit_traces(course)
    size, turn = eigh(unit.T @ unit)
    kept = size > OVERLAP
    along = (turn.T @ (unit.T @ residuals.z))[kept]
    return float((along**2 / size[kept]).sum()), int(kept.sum())


def unit_traces(course: Course) -> Array:
    """(n, k) traces of a course's sensors side by side, each of length one."""
    columns = course.traces.columns[list(course.numbers)]
    flat = columns.swapaxes(0, 1).reshape(columns.shape[1], -1)
    norms = np.linalg.norm(flat, axis=0)
    return np.asarray(flat / np.where(norms > 0, norms, 1.0))


def joined(start: SearchState, course: Course, moments: int) -> tuple[Scored, ...]:
    """The sensors that a course acts on, each scored on what those before it leave.

    They are chosen one after another, and by leaving out one after another: where what sensors show overlaps, many may
    together show what none does alone. The likelier choice stands. The first pays for the choice of one of so many
    ``moments``, and of the sensors.
    """
    sets = {tuple(sorted(chosen(start, course))) for chosen in (one_by_one, all_but_bystanders)}
    return max((priced(start, course, own, moments) for own in sorted(sets)), key=whole_log_evidence)


def whole_log_evidence(event: Sequence[Scored]) -> float:
    """ln evidence of an event."""
    return sum(s.log_evidence for s in event)


def one_by_one(start: SearchState, course: Course) -> list[int]:
    """Numbers of the shapes that join one after another, the strongest first."""
    basis, left = np.zeros((len(start.residuals.z), 0)), list(course.numbers)
    found, statistics = list[int](), list[float]()
    while left:
        tried = [rescored(start.residuals, course.scored(k), basis) for k in left]
        best = int(np.argmax([s.statistic for s in tried]))
        if found and not joins(tried[best].statistic, statistics, start.sensor_count):
            break
        basis = extended_basis(basis, tried[best].trace)
        statistics.append(tried[best].statistic)
        found.append(left.pop(best))
    return found


def all_but_bystanders(start: SearchState, course: Course) -> list[int]:
    """Numbers of the shapes that are left when those go that show nothing beside all others, the weakest first."""
    kept = list(course.numbers)
    while len(kept) > 1:
        statistics = statistics_beside(start.residuals, course.of(kept))
        weakest = int(np.argmin(statistics))
        if joins(statistics[weakest], np.delete(statistics, weakest).tolist(), start.sensor_count):
            break
        kept.pop(weakest)
    return kept


def statistics_beside(residuals: WhitenedResiduals, course: Course) -> Array:
    """(k,) T of every sensor of a course beside all others; the traces of a sensor are of one amplitude."""
    unit = unit_traces(course)
    inverse = np.linalg.pinv(unit.T @ unit, rcond=OVERLAP, hermitian=True)
    return np.asarray((inverse @ (unit.T @ residuals.z)) ** 2 / np.maximum(np.diagonal(inverse), 1e-300))


def priced(start: SearchState, course: Course, numbers: Sequence[int], moments: int) -> tuple[Scored, ...]:
    """Sensors of an event, each scored on what those before it leave; the first pays for the choice."""
    basis, found = np.zeros((len(start.residuals.z), 0)), list[Scored]()
    for k in numbers:
        found.append(rescored(start.residuals, course.scored(k), basis))
        basis = extended_basis(basis, found[-1].trace)
    m = start.sensor_count
    places = moments * comb(m, len(found)) * m
    first = replace(found[0], places=places, log_evidence=found[0].log_evidence - float(np.log(places)))
    return (first, *found[1:])


def joins(statistic: float, others: Sequence[float], m: int) -> bool:
    """Whether a sensor shares the event of others, by their statistics; of m sensors."""
    k, g = len(others), max(float(np.mean(others)) - 1, 1e-3)
    return float(np.log((k + 1) / (m - k)) + 0.5 * statistic * g / (1 + g) - 0.5 * np.log1p(g)) > SURE


def family_p_value(start: SearchState, event: Sequence[Scored]) -> float:
    """p-value of an event or anything as strong in the catalogue, at any moment, on any sensors (Bonferroni)."""
    power, freedom = sum(s.statistic for s in event), sum(s.freedom for s in event)
    return min(1.0, float(chdtrc(freedom, power)) * event[0].places * start.families)


def courses_explain_more(start: SearchState, event: Sequence[Scored]) -> bool:
    """Whether free courses of its sensors, each its own misfortune, explain more than the event; each sensor is looked
    at beside the event of the others."""
    m, gained = start.sensor_count, FURTHER * (len(event) - 1) - float(np.log(event[0].places))
    for own in event:
        attributed, (i,) = beside_others(start, event, own), own.sensors
        course = autocorrelation(start.residuals, attributed, i, known=not start.baseline.unstated[i])
        step = rescored(start.residuals, replace(own, places=1), attributed).log_evidence
        gained += step - (0.0 if course is None else max(course.log_evidence - float(np.log(m)), 0.0))
    return gained < 0


def beside_others(start: SearchState, event: Sequence[Scored], own: Scored) -> Array:
    """(n, f) orthonormal, dimensionless: the span of what an event does to all sensors but one."""
    attributed = np.zeros((len(start.residuals.z), 0))
    for other in event:
        attributed = attributed if other is own else extended_basis(attributed, other.trace)
    return attributed


def ranked(start: SearchState, event: Sequence[Scored]) -> tuple[Found, ...]:
    """The event's sensors as findings, with the causes that the same sensors may share instead; empty where one of
    these is likelier."""
    sensors = sorted(s.sensors[0] for s in event)
    power, freedom = sum(s.statistic for s in event), sum(s.freedom for s in event)
    whole = float(bayes_factor(power, freedom)) - float(np.log(event[0].places))
    rivals = shared_rivals(start, event, sensors)
    if any(log_evidence > whole for _, log_evidence in rivals):
        return ()
    common = [(found.scored(k), e) for found in (scores_given(start, start.traces, None),) for k, e in found.ranked()]
    common = [(s, e) for s, e in common if not s.sensors]
    p_family, found = family_p_value(start, event), []
    for own in event:
        attributed = beside_others(start, event, own)
        again = [(rescored(start.residuals, c.scored(c.on(own.sensors).numbers[0]), attributed), e) for c, e in rivals]
        ranking = sorted([(own, whole), *again, *common], key=lambda pair: -pair[1])
        found.append(Found(own, p_family, tuple(ranking), event=tuple(sensors)))
    return tuple(found)


def shared_rivals(start: SearchState, event: Sequence[Scored], sensors: Sequence[int]) -> list[tuple[Course, float]]:
    """Every other cause that all sensors of an event may share, at its best shape, with its ln evidence."""
    best: dict[str, tuple[Course, float]] = {}
    for traces in start.traces:
        if traces.common or traces.cause.between or traces.beside is not None or traces.cause is event[0].cause:
            continue
        every = [c.on(sensors) for c in courses(start.residuals, traces)]
        every = [c for c in every if len(c.numbers) == len(sensors)]
        if every:
            energy, freedom = energies(start.residuals, every)
            values = bayes_factor(energy, freedom) - np.log(len(every))
            k, name = int(np.argmax(values)), traces.cause.identifier
            if name not in best or values[k] > best[name][1]:
                best[name] = every[k], float(values[k])
    return list(best.values())
