"""One finding of a course that several sensors share: its shape ± U, and how all sensors together read it.

What all sensors read in a row of the course is the size of their common pattern there: with C_r the whitened pattern in
row r and ẑ_r what all findings leave there, it is the course plus C_r'ẑ_r/|C_r|² ± 1/|C_r|.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from estimator.diagnosis.explanation.extended_model import Amplitudes
from estimator.diagnosis.explanation.naming import merged, shared_course
from estimator.diagnosis.posterior.explained import Detection, ExplainedSession
from estimator.diagnosis.results import Finding, Shared
from estimator.message import joined, say
from estimator.session import ACCELEROMETER, GYROSCOPE, Array

ALL, SOME = "all", "some"
"""Groups of sensors; one of a kind is called by the kind."""

WHO = {
    ALL: "all sensors of the block",
    ACCELEROMETER: "all accelerometers of the block",
    GYROSCOPE: "all gyros of the block",
}
"""Groups in words."""

LISTED = 8
"""Sensors that a sentence names; more are counted."""


@dataclass(frozen=True, eq=False)
class CourseMember:
    """A sensor of a shared course."""

    detection: Detection
    finding: Finding
    part: slice
    """Places of its amplitudes among all."""


def shared_finding(state: ExplainedSession, members: Sequence[CourseMember], fitted: Amplitudes) -> Finding:
    """The one finding of sensors that share a course; those that only follow it are counted in it."""
    named = [m for m in members if not m.detection.follows] or list(members)
    more, cause = [m for m in members if m not in named], members[0].detection.best.cause
    group = group_of(state, [m.detection.best.sensors[0] for m in members])
    who = WHO.get(group) or some([m.finding.sensors[0] for m in named], state.sensor_count)
    whole = merged([(cause, m.finding) for m in sorted(named, key=lambda m: m.detection.best.sensors)])[0]
    whole = shared_course(cause, whole, who, len(more) if group == SOME else 0)
    shape, sigma = shape_of(members, fitted)
    course, measured, band = drawn(state, [*named, *more], fitted)
    values = dict(zip(members[0].finding.nonlinear, shape, strict=False))
    shared = Shared(
        group=group,
        shape=values,
        shape_sigma=dict(zip(values, sigma, strict=False)),
        more=tuple(m.finding.sensors[0] for m in more),
        more_amplitude=tuple(m.finding.amplitude[0] for m in more),
        more_sigma=tuple(m.finding.sigma[0] for m in more),
        drawn_for=named[0].finding.sensors[0],
        course=tuple(course.tolist()),
        measured=tuple(measured.tolist()),
        band=tuple(band.tolist()),
        shape_in_doubt=members[0].detection.shape_in_doubt,
    )
    strength = float(np.sqrt(sum(m.finding.strength**2 for m in members)))
    return replace(whole, shared=shared, strength=strength, nonlinear_each=(values,) * len(named))


def some(names: Sequence[str], count: int) -> str:
    """``A1, A4 and A5``, in the order of the block; of many, how many of so many they are."""
    if len(names) > LISTED:
        return say("{names} of {count} sensors", names=len(names), count=count)
    order = sorted(names, key=lambda name: (name.rstrip("0123456789"), len(name), name))
    return joined(" and ", (joined(", ", order[:-1]), order[-1]))


def group_of(state: ExplainedSession, sensors: Sequence[int]) -> str:
    """Describes the sensors of a course: ``all``, all of a kind, or ``some``."""
    kinds = state.baseline.setting.kinds
    if len(sensors) == len(kinds):
        return ALL
    members = {kinds[i] for i in sensors}
    kind = next(iter(members))
    return kind if len(members) == 1 and kinds.count(kind) == len(sensors) else SOME


def shape_of(members: Sequence[CourseMember], fitted: Amplitudes) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """The shape parameters that all have, as findings state them, and the sigma of the continuous one: that of its
    logarithm is fitted beside the sizes."""
    values = tuple(members[0].finding.nonlinear.values())
    for m in members:
        width = len(m.detection.best.cause.units)
        if m.part.stop - m.part.start > width:
            moved, variance = fitted.value[m.part.start + width], fitted.covariance[(m.part.start + width,) * 2]
            value = values[0] * float(np.exp(np.clip(moved, -1.0, 1.0)))
            return (value,), (value * float(np.sqrt(variance)),)
    return values, ()


def drawn(state: ExplainedSession, members: Sequence[CourseMember], fitted: Amplitudes) -> tuple[Array, Array, Array]:
    """(R,) course, (R,) as all sensors read it and (R,) one standard error of that, m/s² (rad/s) of the first."""
    rows, m = state.baseline.setting.rows, state.sensor_count
    size = np.array([fitted.value[member.part.start] for member in members])
    first = members[0].detection.best
    course = first.shape.columns[:, first.sensors[0], 0] * size[0]
    if first.shape.columns.shape[-1] > 1:
        course = course + first.shape.columns[:, first.sensors[0], 1] * fitted.value[members[0].part.start + 1]
    pattern = np.zeros((rows, m, 1))
    pattern[:, [member.detection.best.sensors[0] for member in members], 0] = size / size[0]
    white = state.residuals.whitened(pattern)[: rows * m].reshape(rows, m)
    length = np.maximum(np.linalg.norm(white, axis=1), 1e-300)
    left = (white * state.remaining[: rows * m].reshape(rows, m)).sum(axis=1) / length**2
    course = course - course.mean()
    return course, course + left, 1 / length
