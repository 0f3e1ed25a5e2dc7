"""One event that several sensors show: a shape that they share, and a size of each.

A bump, a break of the supply or a block seated anew moves the zeros of many sensors at one moment. Sensor by sensor
that is as many misfortunes as sensors, which no session has; it is one, and is weighed as one.

Theory
------
The event adds k_i·h(r; ψ) at the input of every sensor i of a set S, with one ψ. Let X(ψ) be the whitened traces of the
sensors side by side, what the calibration absorbs projected out, and X̂ an orthonormal basis of them: T = |X̂'z|² is χ²
without the event, with as many degrees of freedom as sensors (the traces of sensors overlap where a row's β error or an
unknown direction is common to them). ψ is where T of all sensors is largest, of the n_ψ that are tried. Which
sensors belong to the event is chosen there jointly, for the traces of sensors that only follow others overlap with
theirs: with A = X'X of k of m sensors, each trace of length one, and y = X'z, sizes that are N(0, g) give the set

    ln p(S) = ½ y'(A + I/g)⁻¹y − ½ ln|I + g·A| − ln C(m, k),        mean over g     (every k equally likely beforehand)

The event is weighed as one finding against what was found sensor by sensor, and against zeros that wander, each by
itself, or a block that turned (`wandering.py`).
Any cause may be shared: those with a sentence for it (`Cause.shared_sentence`) can be named, the others are rivals.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import comb

import numpy as np

from estimator.arrays import eigh
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.diagnosis.selection.backward import backward_elimination
from estimator.diagnosis.selection.forward import forward_selection, with_structures
from estimator.diagnosis.selection.ranking import extended_basis, scores_given
from estimator.diagnosis.selection.search_state import LEVEL, Detection, SearchState
from estimator.diagnosis.signatures.scores import bayes_factor, rescored
from estimator.diagnosis.signatures.traces import INVISIBLE, Scored, Traces
from estimator.diagnosis.signatures.wandering import log_marginal, log_mean, log_turning, log_wandering, marginal
from estimator.session import Array
from estimator.significance import family_wise, p_value

SURE = float(np.log(19))
"""ln odds by which a sensor joins an event: one in twenty that joined last is a bystander."""

SIZES = 4.0 ** np.arange(1, 9)
"""g: mean square sizes of an event's sensors, standard errors, from 2 to 256 of them; all equally likely."""

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
    rival = searched_with_event(start, event)
    is_likelier = rival is not None and log_evidence(start, rival) > log_evidence(start, state)
    return rival if rival is not None and is_likelier else state


def searched_with_event(start: SearchState, event: tuple[Detection, ...]) -> SearchState | None:
    """What is found beside an event; None where the search takes it for noise."""
    state = forward_selection(replace(start, detections=event))
    if not any(f.event for f in state.detections):
        return None
    return backward_elimination(with_structures(state))


def shared_event(start: SearchState) -> tuple[Detection, ...]:
    """The most likely event, its sensors the strongest first; empty where there is none."""
    candidates = [t for t in start.traces if t.cause.shared_sentence and t.nuisance is None]
    every = [course for traces in candidates for course in courses(start.residuals, traces)]
    if not every:
        return ()
    energy, freedom = energies(start.residuals, every)
    best = np.argsort(-bayes_factor(energy, freedom), kind="stable")[:CLOSEST]
    if p_value(energy[best[0]], freedom[best[0]]) * len(every) > SCREEN:
        return ()
    tried = [(every[k], *joined(start, every[k])) for k in best]
    course, chosen, _ = max(tried, key=lambda candidate: candidate[2])
    event = with_prior_cost(start, course, chosen, len(every)) if len(chosen) > 1 else ()
    if not event or family_p_value(start, event) >= LEVEL or has_likelier_rival(start, course.of(chosen), len(every)):
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
    pairs = [energy_of(residuals, course) for course in every]
    return np.array([energy for energy, _ in pairs]), np.array([freedom for _, freedom in pairs])


def energy_of(residuals: WhitenedResiduals, course: Course) -> tuple[float, int]:
    """T and its degrees of freedom of one course."""
    unit = unit_traces(course)
    size, turn = eigh(unit.T @ unit)
    independent = size > OVERLAP
    along = (turn.T @ (unit.T @ residuals.z))[independent]
    return float((along**2 / size[independent]).sum()), int(independent.sum())


def unit_traces(course: Course) -> Array:
    """(n, k) traces of a course's sensors side by side, each of length one."""
    columns = course.traces.columns[list(course.numbers)]
    flat = columns.swapaxes(0, 1).reshape(columns.shape[1], -1)
    norms = np.linalg.norm(flat, axis=0)
    return np.asarray(flat / np.where(norms > 0, norms, 1.0))


def joined(start: SearchState, course: Course) -> tuple[list[int], float]:
    """Numbers of the shapes of the sensors that a course acts on, and the ln of how likely they are.

    The likeliest set is climbed to from none and from all: where what sensors show overlaps, one of them may show what
    others do, and many together what none does alone.
    """
    unit = unit_traces(course)
    gram, along = unit.T @ unit, unit.T @ start.residuals.z / noise_given_course(start.residuals, course, unit)
    everyone = frozenset(range(len(along)))
    climbed = [likeliest_set(gram, along, start.sensor_count, begun) for begun in (frozenset[int](), everyone)]
    best, value = max(climbed, key=lambda result: result[1])
    return [course.numbers[k] for k in sorted(best)], value


def likeliest_set(gram: Array, along: Array, m: int, begun: frozenset[int]) -> tuple[frozenset[int], float]:
    """The sensors, one joining or leaving at a time from those ``begun`` with, and the ln of how likely they are."""
    best, value = begun, log_likely(gram, along, m, begun)
    while True:
        near = [best ^ {k} for k in range(len(along))]
        values = [log_likely(gram, along, m, members) for members in near]
        if max(values) <= value:
            return best, value
        value = max(values)
        best = near[values.index(value)]


def log_likely(gram: Array, along: Array, m: int, chosen: frozenset[int]) -> float:
    """ln p of a set of sensors, of m, less what every one that joins must be surer; ``gram`` (k, k), ``along`` (k,) of
    traces of length one."""
    members = sorted(chosen)
    power, size = marginal(gram[np.ix_(members, members)], along[members], SIZES)
    return log_mean(0.5 * (power - size)) - float(np.log(comb(m, len(members)))) - SURE * max(len(members) - 1, 0)


def noise_given_course(residuals: WhitenedResiduals, course: Course, unit: Array) -> Array:
    """(k,) scatter of a course's sensors beside it, standard errors: 1 where the noise is known."""
    size, turn = eigh(unit.T @ unit)
    basis = unit @ (turn[:, size > OVERLAP] / np.sqrt(size[size > OVERLAP]))
    remaining, N = (residuals.z - basis @ (basis.T @ residuals.z)) ** 2, residuals.rows
    freedom, sensors = residuals.row_freedom - (basis[:N] ** 2).sum(axis=1), course.traces.sensor[list(course.numbers)]
    of_sensor = residuals.sensor_of_row[:N] == sensors[:, None]
    ratio = (of_sensor @ remaining[:N]) / np.maximum(of_sensor @ freedom, 1.0)
    return np.asarray(np.where(residuals.baseline.unstated[sensors], np.sqrt(ratio), 1.0))


def with_prior_cost(start: SearchState, course: Course, numbers: Sequence[int], moments: int) -> tuple[Scored, ...]:
    """Sensors of an event, each scored on what those before it leave; the first pays for the choice of them, and of
    one of so many ``moments``."""
    basis, priced_scores = np.zeros((len(start.residuals.z), 0)), list[Scored]()
    for k in numbers:
        priced_scores.append(rescored(start.residuals, course.scored(k), basis))
        basis = extended_basis(basis, priced_scores[-1].trace)
    m = start.sensor_count
    places = moments * comb(m, len(priced_scores)) * m
    first = replace(priced_scores[0], places=places, log_evidence=priced_scores[0].log_evidence - float(np.log(places)))
    return (first, *priced_scores[1:])


def family_p_value(start: SearchState, event: Sequence[Scored]) -> float:
    """p-value of an event or anything as strong in the catalogue, at any moment, on any sensors (Bonferroni)."""
    power, freedom = sum(s.statistic for s in event), sum(s.freedom for s in event)
    return family_wise(float(p_value(power, freedom)), event[0].places * start.families)


def has_likelier_rival(start: SearchState, course: Course, moments: int) -> bool:
    """Whether something else is likelier than an event of a course's sensors at one of so many ``moments``: zeros that
    wander, each by itself, or the whole block turned at one moment."""
    m, k = start.sensor_count, len(course.numbers)
    event = log_mean(log_marginal(start.residuals, unit_traces(course), SIZES)) - float(np.log(moments))
    rivals = log_wandering(start.residuals), log_turning(start.residuals, SIZES)
    return event - float(np.log(m * comb(m, k))) < max(rivals)


def joint_with_others(start: SearchState, event: Sequence[Scored], member: Scored) -> Array:
    """(n, f) orthonormal, dimensionless: the span of what an event does to all sensors but one."""
    attributed = np.zeros((len(start.residuals.z), 0))
    for other in event:
        attributed = attributed if other is member else extended_basis(attributed, other.trace)
    return attributed


def ranked(start: SearchState, event: Sequence[Scored]) -> tuple[Detection, ...]:
    """The event's sensors as findings, with the causes that the same sensors may share instead; empty where one of
    these is likelier."""
    sensors = sorted(s.sensors[0] for s in event)
    power, freedom = sum(s.statistic for s in event), sum(s.freedom for s in event)
    whole = float(bayes_factor(power, freedom)) - float(np.log(event[0].places))
    rivals = shared_rivals(start, event, sensors)
    if any(log_evidence > whole for _, log_evidence in rivals):
        return ()
    common = [
        (detections.scored(k), e)
        for detections in (scores_given(start, start.traces, None),)
        for k, e in detections.ranked()
    ]
    common = [(s, e) for s, e in common if not s.sensors]
    p_family, detections = family_p_value(start, event), []
    for member in event:
        attributed = joint_with_others(start, event, member)
        again = [
            (rescored(start.residuals, c.scored(c.on(member.sensors).numbers[0]), attributed), e) for c, e in rivals
        ]
        ranking = sorted([(member, whole), *again, *common], key=lambda pair: -pair[1])
        detections.append(Detection(member, p_family, tuple(ranking), event=tuple(sensors)))
    return tuple(detections)


def shared_rivals(start: SearchState, event: Sequence[Scored], sensors: Sequence[int]) -> list[tuple[Course, float]]:
    """Every other cause that all sensors of an event may share, at its best shape, with its ln evidence."""
    best: dict[str, tuple[Course, float]] = {}
    for traces in start.traces:
        if traces.common or traces.cause.between or traces.nuisance is not None or traces.cause is event[0].cause:
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
