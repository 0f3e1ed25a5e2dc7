"""Finds the sensors of a shared course that have a shape of their own, or whose parameters changed for good.

Theory
------
A sensor k departs where one of the shapes that are tried, other than that of the rest, explains so much more of what it
shows, beside the others at theirs, that it is likelier in spite of one misfortune more. First the shape of all is moved
to its best, between those that are tried: next to a course of hundreds of standard errors every sensor would depart
from the nearest of them. With a history a change of the sensor is the rival of its departure: a zero that changed looks
like one that settles with a longer time constant. It is weighed with the shape of the others moved to its best beside
it, since what changed pulls that too.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.diagnosis.selection.backward import FURTHER
from estimator.diagnosis.selection.event_course import (
    EventCourse,
    between_tried,
    courses,
    energies,
    energy_of,
    unit_traces,
)
from estimator.diagnosis.selection.membership import CauseMembers
from estimator.diagnosis.selection.ranking import extended_basis
from estimator.diagnosis.selection.search_state import NEW_DIRECTION, SearchState
from estimator.diagnosis.selection.shared_shape import APART, log_shared, powers
from estimator.diagnosis.signatures.scores import score
from estimator.diagnosis.signatures.traces import Scored
from estimator.least_squares import orthonormal
from estimator.session import Array

NEAREST = 3
"""Sensors whose own shapes, of those tried, gain most, of which these are moved to their best."""


@dataclass(frozen=True, eq=False)
class Followed:
    """A course with the sensors that follow it."""

    course: EventCourse
    """The course of these sensors alone."""
    departing: tuple[Scored, ...]
    """The own shapes of sensors that would otherwise follow."""
    changed: tuple[Scored, ...]
    """Lasting changes of a sensor since the history."""
    sure: frozenset[int]
    """Sensors that can be named alone."""
    log_evidence: float
    """ln evidence against no effect, the choice of shape and sensors paid for."""
    shape_in_doubt: bool
    """Whether a shape of its own for every sensor may explain as much (`shared_shape.py`)."""


def without_departing(start: SearchState, course: EventCourse, members: CauseMembers) -> Followed | None:
    """A course with its members, but for those that have a shape of their own; None where all fit better apart.

    Before any is taken to depart, the shape of all is moved between those that were tried. A shape that is left out
    would pull what all sensors share of a row: every one found stays beside the others. So does a change since the
    history where it is likelier than such a shape: its sensor goes on following.
    """
    kept, is_between = course.of([course.numbers[k] for k in members.chosen]), False
    departing, changed = list[Scored](), list[Scored]()
    while len(kept.numbers) > 1:
        beside, every = basis_of(start, (*departing, *changed)), courses(start.residuals, kept.traces)
        others = [other.on(kept.sensors) for other in every if set(kept.sensors) <= set(other.sensors)]
        apart, own = powers_apart(start, kept, others, beside)
        if is_between:
            worst, shape, gained = best_own_shape(start, kept, others, (apart, own), beside)
        else:
            gained = 0.5 * max(float(values.max() - known) for values, known in zip(apart, own, strict=True))
        of_shape = gained - float(np.log(course.tried))
        change, moved, of_change = likeliest_change(start, kept, beside)
        if max(of_shape, of_change) < FURTHER:
            break
        if not is_between:
            kept, is_between = between_tried(start.residuals, kept, beside), True
        elif of_change > of_shape:
            kept, changed = moved, [*changed, *change]
        else:
            departing.append(shape.scored(shape.numbers[0]))
            kept, is_between = kept.of([number for k, number in enumerate(kept.numbers) if k != worst]), False
    if len(kept.numbers) < 2:
        return None
    log_one_shape = log_shared(
        energies(start.residuals, others, beside)[0], energy_of(start.residuals, kept, beside)[0], apart, own
    )
    if log_one_shape < APART:
        return None
    sure = {course.sensors[k] for k in members.sure} & set(kept.sensors)
    in_doubt = len(others) > 1 and log_one_shape < -APART
    log_evidence = members.log_evidence - float(np.log(course.tried))
    return Followed(kept, tuple(departing), tuple(changed), frozenset(sure), log_evidence, in_doubt)


def own_shape(others: Sequence[EventCourse], apart: Sequence[Array], k: int) -> EventCourse:
    """The shape, of those tried, that the k-th sensor of a course shows best."""
    course = others[int(np.argmax(apart[k]))]
    return course.of([course.numbers[k]])


def best_own_shape(
    start: SearchState,
    kept: EventCourse,
    others: Sequence[EventCourse],
    powers_of_each: tuple[Sequence[Array], Sequence[float]],
    beside: Array,
) -> tuple[int, EventCourse, float]:
    """The sensor of a course that a shape of its own, moved to its best too, suits best: its place, that shape, and
    half of what it explains more; ``powers_of_each`` as `powers_apart` gives them."""
    apart, own = powers_of_each
    tried = []
    for k in np.argsort([known - values.max() for values, known in zip(apart, own, strict=True)])[:NEAREST].tolist():
        rest = kept.of([number for i, number in enumerate(kept.numbers) if i != k])
        basis = extended_basis(beside, unit_traces(rest))
        shape = between_tried(start.residuals, own_shape(others, apart, k), basis)
        tried.append((k, shape, 0.5 * (energy_of(start.residuals, shape, basis)[0] - own[k])))
    return max(tried, key=lambda one: one[2])


def likeliest_change(
    start: SearchState, kept: EventCourse, beside: Array
) -> tuple[tuple[Scored, ...], EventCourse, float]:
    """The likeliest lasting change of one sensor since the history, a course moved to its best beside it, and the ln
    evidence that both bring; ``beside`` (n, f) orthonormal traces. Empty, the course as it is and 0 where nothing
    changed.
    """
    since, z = [traces for traces in start.traces if traces.cause.moves_parameters], start.residuals.z
    found = score(start.residuals, since, extended_basis(beside, unit_traces(kept))) if since else []
    if not found:
        return (), kept, 0.0
    change = max(found, key=lambda scored: scored.log_evidence)
    both = extended_basis(beside, change.trace)
    moved = between_tried(start.residuals, kept, both)
    whole = energy_of(start.residuals, moved, both)[0] + float(((both.T @ z) ** 2).sum() - ((beside.T @ z) ** 2).sum())
    gained = 0.5 * (whole - energy_of(start.residuals, kept, beside)[0] - change.statistic)
    return (change,), moved, change.log_evidence + gained


def basis_of(start: SearchState, others: Sequence[Scored]) -> Array:
    """(n, f) orthonormal traces of other effects."""
    columns = np.concatenate([np.zeros((len(start.residuals.z), 0)), *(s.trace for s in others)], axis=1)
    return orthonormal(columns, NEW_DIRECTION)


def powers_apart(
    start: SearchState, course: EventCourse, others: Sequence[EventCourse], departing: Array
) -> tuple[list[Array], list[float]]:
    """The power of each sensor of a course by its shape in every one of ``others``, beside what the rest of them share
    and ``departing`` (n, d) traces, and by the shape that it shares with them.
    """
    shared, every, own = unit_traces(course), list[Array](), list[float]()
    for k in range(len(course.sensors)):
        of_sensor = course.traces.columns[[other.numbers[k] for other in others], :, 0].T
        beside = np.column_stack([np.delete(shared, k, axis=1), departing])
        values = powers(start.residuals.z, np.column_stack([shared[:, k], of_sensor]), beside)
        every.append(values[1:])
        own.append(float(values[0]))
    return every, own
