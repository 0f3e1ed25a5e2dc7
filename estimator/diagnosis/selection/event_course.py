"""The shapes of causes that several sensors may share: one a sensor, with the same nonlinear parameter."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from estimator.arrays import eigh
from estimator.causes.contract import SensorCause, Shape
from estimator.causes.shared import KINDS, SharedCourse, of_kind
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.diagnosis.selection.search_state import SearchState
from estimator.diagnosis.selection.shared_shape import at_its_best
from estimator.diagnosis.signatures.free_course import FreeCourse
from estimator.diagnosis.signatures.lasting import lengths
from estimator.diagnosis.signatures.products import Products
from estimator.diagnosis.signatures.traces import INVISIBLE, Scored, Traces, sensors_of
from estimator.diagnosis.signatures.wandering import wanderings
from estimator.session import Array

OVERLAP = 1e-4
"""Least eigenvalue of the correlation of traces that counts as a direction: below it amplitudes would cancel."""
ONE_ROW = 0.7
"""Share of a shape's energy that one row may hold, as the first does of a block that settles within three: more is
something that befell the row."""


@dataclass(frozen=True, eq=False)
class EventCourse:
    """A cause's shapes with one nonlinear parameter, one shape a sensor."""

    traces: Traces
    numbers: tuple[int, ...]
    """Numbers of the shapes, in the order of the sensors."""
    tried: float
    """n_ψ, how many nonlinear parameters the cause is tried with."""

    @property
    def sensors(self) -> tuple[int, ...]:
        """Numbers of the sensors that its shapes belong to."""
        return tuple(int(i) for i in self.traces.sensor[list(self.numbers)])

    def on(self, sensors: Sequence[int]) -> "EventCourse":
        """The course on some of its sensors."""
        return self.of([k for k in self.numbers if self.traces.sensor[k] in sensors])

    def of(self, numbers: Sequence[int]) -> "EventCourse":
        """The course with the shapes of some numbers."""
        return replace(self, numbers=tuple(numbers))

    def scored(self, k: int) -> Scored:
        """The shape of one number, still to be scored."""
        shape, trace = self.traces.whole(k)
        return Scored(self.traces.cause, shape, self.traces.lasting[k], trace, 0.0, 0, 0.0, 1.0, 1, shared=True)


def between_tried(residuals: WhitenedResiduals, course: EventCourse, beside: Array) -> EventCourse:
    """A course at the nonlinear parameter, near the one that it has, that its sensors show best ``beside`` (n, f)
    orthonormal traces; its traces hold those that were tried too."""
    traces, cause = course.traces, course.traces.cause
    assert isinstance(cause, SensorCause)
    known, lasting = traces.shapes[course.numbers[0]], traces.lasting[course.numbers[0]]
    shapes, columns = at_its_best(residuals, cause, course.sensors, known, beside, lasting=lasting)
    if not shapes:
        return course
    every, trace = (*traces.shapes, *shapes), np.concatenate([traces.columns, columns.T[..., None]])
    raw = lengths(residuals.whitened(np.concatenate([shape.columns for shape in shapes], axis=-1)))
    both = replace(
        traces,
        shapes=every,
        lasting=(*traces.lasting, *(lasting for _ in shapes)),
        sensor=sensors_of(every),
        columns=trace,
        raw=np.concatenate([traces.raw, raw[:, None]]),
        products=Products.of(residuals, trace),
    )
    return replace(course, traces=both, numbers=tuple(range(len(traces.shapes), len(every))))


def courses(residuals: WhitenedResiduals, traces: Traces) -> list[EventCourse]:
    """A cause's shapes by their nonlinear parameters, where two sensors or more show them in more rows than one."""
    rows, m = residuals.baseline.residual.size, len(residuals.baseline.unstated)
    square = np.einsum("snq,snq->sn", traces.columns[:, :rows], traces.columns[:, :rows])
    shown = np.sqrt(square.sum(axis=1)) > INVISIBLE * np.linalg.norm(traces.raw, axis=1)
    of_row = square.reshape(len(square), -1, m).sum(axis=2)
    shown &= of_row.max(axis=1) < ONE_ROW * of_row.sum(axis=1)
    grouped: dict[tuple[float, ...], list[int]] = {}
    for k in np.flatnonzero(shown & (traces.sensor >= 0)).tolist():
        grouped.setdefault(traces.shapes[k].nonlinear, []).append(k)
    several = [tuple(numbers) for numbers in grouped.values() if len(numbers) > 1]
    return [EventCourse(traces, numbers, len(several)) for numbers in several]


def without_formula(start: SearchState) -> list[EventCourse]:
    """The likeliest course of each kind that no formula gives, of all sensors; none in a block of one, nor in noise
    that what it leaves must tell."""
    if start.sensor_count < 2 or start.baseline.unstated.any():
        return []
    kinds = enumerate(wanderings(start.residuals))
    return [course for kind, wandering in kinds for course in free_course(start, kind, wandering.trace)]


def free_course(start: SearchState, kind: int, waves: Array) -> list[EventCourse]:
    """The likeliest course of one kind, with traces ``waves`` (n, m·w) on all sensors; empty where too few sensors show
    it.
    """
    residuals, setting, m = start.residuals, start.baseline.setting, start.sensor_count
    found, cause = FreeCourse.of(waves, residuals.z, m), SharedCourse()
    nonlinear = of_kind(kind, found.waves)
    shapes = tuple(Shape((i,), cause.placed(setting, i, nonlinear), nonlinear) for i in range(m))
    columns = np.concatenate([shape.columns for shape in shapes], axis=-1)
    trace, raw = residuals.trace(columns, 0.0).T[..., None], np.linalg.norm(residuals.whitened(columns), axis=0)
    products, sensor = Products.of(residuals, trace), np.arange(m)
    traces = Traces(cause, shapes, (False,) * m, sensor, trace, raw[:, None], m, products)
    return [replace(course, tried=len(KINDS) * found.tried) for course in courses(residuals, traces)]


def energies(
    residuals: WhitenedResiduals, every: Sequence[EventCourse], beside: Array | None = None
) -> tuple[Array, Array]:
    """(C,) T and (C,) int its degrees of freedom of courses, each with a size of every sensor, ``beside`` (n, f)
    orthonormal traces of something else."""
    pairs = [energy_of(residuals, course, beside) for course in every]
    return np.array([energy for energy, _ in pairs]), np.array([freedom for _, freedom in pairs])


def energy_of(residuals: WhitenedResiduals, course: EventCourse, beside: Array | None = None) -> tuple[float, int]:
    """T and its degrees of freedom of one course."""
    unit = unit_traces(course)
    if beside is not None:
        unit = unit - beside @ (beside.T @ unit)
    size, turn = eigh(unit.T @ unit)
    independent = size > OVERLAP
    along = (turn.T @ (unit.T @ residuals.z))[independent]
    return float((along**2 / size[independent]).sum()), int(independent.sum())


def unit_traces(course: EventCourse) -> Array:
    """(n, k) traces of a course's sensors side by side, each of length one."""
    columns = course.traces.columns[list(course.numbers)]
    flat = columns.swapaxes(0, 1).reshape(columns.shape[1], -1)
    norms = np.linalg.norm(flat, axis=0)
    return np.asarray(flat / np.where(norms > 0, norms, 1.0))
