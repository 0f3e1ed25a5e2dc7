"""One course that several sensors show: a shape that they share, and a size of each.

A board that warms, a bump or a break of the supply moves many sensors at once. Sensor by sensor that is as many
misfortunes as sensors, which no session has; it is one, and is weighed as one.

Theory
------
The course adds k_i·h(r; ψ) at the input of every sensor i of a set S, with one ψ. Let X(ψ) be the whitened traces of
the sensors side by side, what the calibration absorbs projected out, and X̂ an orthonormal basis of them: T = |X̂'z|² is
χ² without the course, with as many degrees of freedom as sensors (the traces of sensors overlap where a row's β error
or an unknown direction is common to them). Of the n_ψ shapes of every cause those are looked at closely by which most
sensors, or a few, show most. Which sensors follow is chosen there (`membership.py`), and which of them rather have a
shape of their own or have changed for good (`departing.py`); then ψ is moved to its best.

The course is weighed as one finding against what was found sensor by sensor, against zeros that wander, each by
itself, beside it or instead of it, and against a block that turned (`wandering.py`).
Any cause may be shared: those with a sentence for it (`Cause.shared_sentence`) can be named, the others are rivals.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from estimator.arrays import eigh
from estimator.causes.contract import SensorCause
from estimator.causes.shared import SharedCourse
from estimator.content import once
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.diagnosis.selection.backward import FURTHER, backward_elimination
from estimator.diagnosis.selection.departing import Followed, basis_of, without_departing
from estimator.diagnosis.selection.event_course import (
    OVERLAP,
    EventCourse,
    courses,
    energies,
    unit_traces,
    without_formula,
)
from estimator.diagnosis.selection.forward import forward_selection, with_structures
from estimator.diagnosis.selection.membership import SIZES, SURE, Loadings, counts_of, log_sets
from estimator.diagnosis.selection.ranking import conditional_log_evidence, extended_basis, scores_given
from estimator.diagnosis.selection.search_state import LEVEL, NEW_DIRECTION, Detection, SearchState
from estimator.diagnosis.selection.shared_shape import refined_together
from estimator.diagnosis.signatures.scores import bayes_factor, rescored
from estimator.diagnosis.signatures.traces import Scored
from estimator.diagnosis.signatures.wandering import (
    log_beside_wandering,
    log_marginal,
    log_mean,
    log_turning,
)
from estimator.least_squares import orthonormal
from estimator.session import Array
from estimator.significance import family_wise, p_value

SCREEN = 0.01
"""p-value of the best course, all courses together, below which it is looked at closely; it names nothing."""
CLOSEST = 3
"""Courses that are looked at closely by either measure, beside the best of every cause: next to the best one others may
explain almost as much."""
MOST = 1e15
"""Shapes and sets of sensors that are counted: nothing that was chosen among more is believed."""
RULED_OUT = 20.0
"""ln evidence by which a rival of a course is out of the question: no list shows a share of 1e-9."""


def with_shared_event(
    start: SearchState, state: SearchState, log_evidence: Callable[[SearchState, SearchState], float]
) -> SearchState:
    """The state, or its rival with one course that sensors share and what is found beside it, whichever is likelier.

    ``start``: nothing found; ``log_evidence`` of a state against ``start``.
    """
    rival = searched_with_event(start)
    is_likelier = rival is not None and log_evidence(start, rival) > log_evidence(start, state)
    return rival if rival is not None and is_likelier else state


@once
def searched_with_event(start: SearchState) -> SearchState | None:
    """Searches beside a shared course; None where there is none or the search takes it for noise."""
    event = shared_event(start)
    state = forward_selection(replace(start, detections=event)) if event else start
    if not any(f.event for f in state.detections):
        return None
    return backward_elimination(with_structures(state))


def is_plainly_shared(start: SearchState) -> bool:
    """Whether a shared course explains so much more than each sensor's own likeliest cause that it is certain."""
    event = shared_event(start)
    if not event:
        return False
    nothing = np.zeros((len(start.residuals.z), 0))
    own: dict[int, Detection] = {}
    given = scores_given(start, start.traces, None)
    for k, value in given.ranked():
        if value > FURTHER:
            own.setdefault(int(given.sensor[k]), Detection(given.scored(k), 0.0, ()))
    apart = conditional_log_evidence(start.residuals, nothing, tuple(own.values())) - FURTHER * max(len(own) - 1, 0)
    return conditional_log_evidence(start.residuals, nothing, event) - apart > RULED_OUT


@once
def shared_event(start: SearchState) -> tuple[Detection, ...]:
    """The most likely shared course, its sensors the strongest first; empty where there is none."""
    candidate = None if start.apart else significant_course(start)
    if candidate is None or has_likelier_rival(start, candidate[0]):
        return ()
    return ranked(start, *candidate)


def is_apart(start: SearchState) -> bool:
    """Whether sensors show a common course, but are likelier to wander each by itself: they then share nothing,
    whatever the noise is taken to be.
    """
    candidate = significant_course(start)
    return candidate is not None and has_likelier_rival(start, candidate[0])


@once
def significant_course(start: SearchState) -> tuple[Followed, tuple[Scored, ...]] | None:
    """The likeliest course that several sensors follow, and what each shows; None where none is significant."""
    candidates = [t for t in start.traces if t.cause.shared_sentence and t.nuisance is None]
    every = [course for traces in candidates for course in courses(start.residuals, traces)]
    every += without_formula(start)
    followed = likeliest(start, closest(start, every)) if every else None
    event = () if followed is None else priced(start, followed)
    if followed is None or family_p_value(start, event) >= LEVEL:
        return None
    return followed, event


def departures(start: SearchState) -> tuple[Detection, ...]:
    """The sensors that depart from the likeliest course, each with its own shape."""
    candidate = significant_course(start)
    if candidate is None:
        return ()
    nothing = np.zeros((len(start.residuals.z), 0))
    scored = [rescored(start.residuals, shape, nothing) for shape in candidate[0].departing]
    return tuple(Detection(s, s.p_value, ()) for s in scored)


def closest(start: SearchState, every: Sequence[EventCourse]) -> list[EventCourse]:
    """The courses that all sensors together, or a few of them, show best; none where that is chance."""
    energy, freedom = energies(start.residuals, every)
    price = np.log([course.tried for course in every])
    whole = bayes_factor(energy, freedom) - price
    few = likeliest_few(start, every) - price
    if (p_value(energy, freedom) * len(every)).min() > SCREEN and few.max() < SURE:
        return []
    by_whole = np.argsort(-whole, kind="stable").tolist()
    of_cause = {id(every[k].traces): k for k in reversed(by_whole)}
    by_few = np.argsort(-few, kind="stable").tolist()
    return [every[k] for k in dict.fromkeys([*by_whole[:CLOSEST], *by_few[:CLOSEST], *of_cause.values()])]


def likeliest_few(start: SearchState, every: Sequence[EventCourse]) -> Array:
    """(C,) ln p of the likeliest set of each course's sensors (`membership.py`) if their traces did not overlap."""
    kinds = start.baseline.setting.kinds
    counts, values = counts_of(kinds), []
    price = np.array([log_sets(counts, set(kinds), k) for k in range(1, len(kinds) + 1)])
    grown = 1 + SIZES[:, None]
    for course in every:
        along = np.sort((start.residuals.z @ unit_traces(course)) ** 2)[::-1]
        each = np.cumsum(0.5 * along * SIZES[:, None] / grown - 0.5 * np.log(grown), axis=1)
        together = np.logaddexp.reduce(each, axis=0) - np.log(len(SIZES))
        values.append((together - price[: len(together)]).max())
    return np.array(values)


def likeliest(start: SearchState, near: Sequence[EventCourse]) -> Followed | None:
    """The likeliest course that several sensors share rather than one having it; None where there is none."""
    tried = [(course, loadings(start, course).members()) for course in near]
    tried = [(course, members) for course, members in tried if members.are_several]
    if not tried:
        return None
    course, members = max(tried, key=lambda pair: pair[1].log_evidence - np.log(pair[0].tried))
    return without_departing(start, course, members)


def loadings(start: SearchState, course: EventCourse) -> Loadings:
    """The sensors' response along a course, in the noise that it leaves where none is known."""
    unit, kinds = unit_traces(course), start.baseline.setting.kinds
    along = unit.T @ start.residuals.z / noise_given_course(start.residuals, course, unit)
    return Loadings(unit.T @ unit, along, tuple(kinds[i] for i in course.sensors), counts_of(kinds))


def noise_given_course(residuals: WhitenedResiduals, course: EventCourse, unit: Array) -> Array:
    """(k,) scatter of a course's sensors beside it, standard errors: 1 where the noise is known."""
    size, turn = eigh(unit.T @ unit)
    basis = unit @ (turn[:, size > OVERLAP] / np.sqrt(size[size > OVERLAP]))
    remaining, N = (residuals.z - basis @ (basis.T @ residuals.z)) ** 2, residuals.rows
    freedom, sensors = residuals.row_freedom - (basis[:N] ** 2).sum(axis=1), course.traces.sensor[list(course.numbers)]
    of_sensor = residuals.sensor_of_row[:N] == sensors[:, None]
    ratio = (of_sensor @ remaining[:N]) / np.maximum(of_sensor @ freedom, 1.0)
    return np.asarray(np.where(residuals.baseline.unstated[sensors], np.sqrt(ratio), 1.0))


def places_of(start: SearchState, course: EventCourse) -> float:
    """Number of shapes and sets of sensors among which a course with its sensors was chosen."""
    kinds = start.baseline.setting.kinds
    return course.tried * float(
        np.exp(log_sets(counts_of(kinds), {kinds[i] for i in course.sensors}, len(course.numbers)))
    )


def priced(start: SearchState, followed: Followed) -> tuple[Scored, ...]:
    """Sensors of a course at its best shape, each scored on what those before it leave, the strongest first; the first
    pays for the choice of shape and sensors."""
    course = followed.course
    strength = np.abs(unit_traces(course).T @ start.residuals.z)
    order = [course.numbers[k] for k in np.argsort(-strength, kind="stable").tolist()]
    basis, scored = basis_of(start, (*followed.changed, *followed.departing)), list[Scored]()
    for member in refined_together(start.residuals, [course.scored(k) for k in order], basis):
        scored.append(rescored(start.residuals, member, basis))
        basis = extended_basis(basis, scored[-1].trace)
    places = max(round(min(places_of(start, course), MOST)), 1)
    first = replace(scored[0], places=places, log_evidence=scored[0].log_evidence - float(np.log(places)))
    return (first, *scored[1:])


def family_p_value(start: SearchState, event: Sequence[Scored]) -> float:
    """p-value of a course or anything as strong in the catalogue, of any shape, on any sensors (Bonferroni)."""
    power, freedom = sum(s.statistic for s in event), sum(s.freedom for s in event)
    return family_wise(float(p_value(power, freedom)), event[0].places * start.families)


def has_likelier_rival(start: SearchState, followed: Followed) -> bool:
    """Whether a rival is likelier than a shared course: zeros that each wander by themselves, or the whole block turned
    at one moment.

    Zeros that wander are a misfortune more at least, but where a course has no formula or the noise is not known, which
    lets many things pass for a course. Beside zeros that wander a course must be plain. Where most sensors follow it,
    those that depart from it have their own shapes beside it, each of them a misfortune more. What changed since the
    history did so beside either.
    """
    course, departing = followed.course, followed.departing
    departing = departing if len(departing) < len(course.numbers) else ()
    price = float(np.log(places_of(start, course))) + len(departing) * (FURTHER + float(np.log(course.tried)))
    price += sum(change.log_evidence for change in followed.changed)
    unit = np.column_stack([unit_traces(course), basis_of(start, (*departing, *followed.changed))])
    alone = log_mean(log_marginal(start.residuals, unit, SIZES)) - price
    wandering, beside = log_beside_wandering(start.residuals, unit, SIZES)
    if log_turning(start.residuals, SIZES) > max(alone, beside - price):
        return True
    has_formula = not isinstance(course.traces.cause, SharedCourse)
    margin = FURTHER if has_formula and not start.baseline.unstated.any() else 0.0
    return alone < wandering - margin and beside - price - SURE < wandering


def ranked(start: SearchState, followed: Followed, event: Sequence[Scored]) -> tuple[Detection, ...]:
    """The course's sensors as findings, with the causes that the same sensors may share instead; empty where one of
    these is likelier.

    One that can be named was a candidate with the sensors that follow it (`closest`), and is an alternative at most.
    """
    sensors = followed.course.sensors
    power, freedom = sum(s.statistic for s in event), sum(s.freedom for s in event)
    whole = float(bayes_factor(power, freedom)) - float(np.log(followed.course.tried))
    rivals = shared_rivals(start, event, sensors, basis_of(start, followed.changed))
    if any(log_evidence > whole for course, log_evidence in rivals if not course.traces.cause.shared_sentence):
        return ()
    rivals = [(course, min(evidence, whole)) for course, evidence in rivals if evidence > whole - RULED_OUT]
    given = scores_given(start, start.traces, None)
    common = [(given.scored(k), e) for k, e in given.ranked() if given.sensor[k] < 0]
    p_family, named = family_p_value(start, event), followed.sure if len(followed.sure) > 1 else frozenset(sensors)
    detections = []
    for member in event:
        others = orthonormal(np.concatenate([o.trace for o in event if o is not member], axis=1), NEW_DIRECTION)
        again = [(rescored(start.residuals, c.scored(c.on(member.sensors).numbers[0]), others), e) for c, e in rivals]
        ranking = sorted([(member, whole), *again, *common], key=lambda pair: -pair[1])
        follows = member.sensors[0] not in named
        detections.append(
            Detection(
                member,
                p_family,
                tuple(ranking),
                event=tuple(sorted(sensors)),
                follows=follows,
                shape_in_doubt=followed.shape_in_doubt,
            )
        )
    return tuple(detections)


def shared_rivals(
    start: SearchState, event: Sequence[Scored], sensors: Sequence[int], beside: Array
) -> list[tuple[EventCourse, float]]:
    """Every other cause that all sensors of a course may share, at its best shape, with its ln evidence ``beside``
    (n, f) orthonormal traces."""
    best: dict[str, tuple[EventCourse, float]] = {}
    for traces in start.traces:
        if traces.common or traces.cause.between or traces.nuisance is not None or traces.cause is event[0].cause:
            continue
        every = [c.on(sensors) for c in courses(start.residuals, traces)]
        every = [c for c in every if len(c.numbers) == len(sensors)]
        if every and isinstance(traces.cause, SensorCause):
            energy, freedom = energies(start.residuals, every, beside)
            values = bayes_factor(energy, freedom) - np.log(len(every))
            k, name = int(np.argmax(values)), traces.cause.identifier
            if name not in best or values[k] > best[name][1]:
                best[name] = every[k], float(values[k])
    return list(best.values())
