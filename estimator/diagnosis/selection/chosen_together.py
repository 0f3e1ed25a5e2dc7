"""The shape of a course that sensors share, chosen again from rows that are not held out: one for all of them.

A course without a formula is fitted anew to these rows (`free_course.py`): the rows held out took part in its shape.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from estimator.causes.contract import SensorCause
from estimator.causes.shared import KINDS, SharedCourse, kind_of, of_kind
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.diagnosis.selection.search_state import Detection
from estimator.diagnosis.signatures.free_course import FreeCourse
from estimator.diagnosis.signatures.traces import Traces
from estimator.session import Array

Priced = tuple[Array, float]
"""Columns (R, m, k), m/s² (rad/s), of a shape on all sensors of a course, and the ln of those it was chosen among."""


def units(judged: Sequence[Detection]) -> list[tuple[Detection, ...]]:
    """Findings that are chosen again as one: those of each shared course, and every other by itself."""
    together: dict[object, list[Detection]] = {}
    for f in judged:
        together.setdefault((f.best.cause.identifier, f.event) if f.event else f, []).append(f)
    return [tuple(members) for members in together.values()]


def shapes_together(every: Sequence[Traces], members: Sequence[Detection], leaders: int) -> Iterator[Priced]:
    """The shapes among which that of a course is chosen again, those of its rivals in the ranking among them."""
    sensors = [f.best.sensors[0] for f in members]
    names = {s.cause.identifier for s, _ in members[0].ranking[:leaders]}
    for traces in every:
        if traces.cause.identifier not in names or traces.common or traces.cause.between or traces.nuisance is not None:
            continue
        grouped: dict[tuple[float, ...], dict[int, Array]] = {}
        for shape in traces.shapes:
            grouped.setdefault(shape.nonlinear, {})[shape.sensors[0]] = shape.columns
        for of_sensor in grouped.values():
            if all(i in of_sensor for i in sensors):
                yield np.concatenate([of_sensor[i] for i in sensors], axis=-1), float(np.log(len(grouped)))


def without_formula(
    residuals: WhitenedResiduals, members: Sequence[Detection], remaining: Array, basis: Array, z: Array
) -> Iterator[Priced]:
    """The course that the rows left show best, where the one found has no formula.

    ``remaining`` (N,) bool, ``basis`` (n, p) orthonormal and z (n,) of these rows, standard errors.
    """
    cause, setting = members[0].best.cause, residuals.baseline.setting
    if not isinstance(cause, SharedCourse):
        return
    sensors, kind = [f.best.sensors[0] for f in members], kind_of(members[0].best.shape.nonlinear)
    waves, size = KINDS[kind](setting.rows), np.sqrt(np.median(residuals.baseline.variance, axis=0))[sensors]
    columns = np.zeros((setting.rows, len(setting.kinds), len(sensors), waves.shape[1]))
    columns[:, sensors, np.arange(len(sensors))] = waves[:, None, :] * size[:, None]
    rows = residuals.whitened(columns.reshape(*columns.shape[:2], -1))[remaining]
    found = FreeCourse.of(rows - basis @ (basis.T @ rows), z, len(sensors))
    yield on_sensors(residuals, cause, sensors, of_kind(kind, found.waves)), float(np.log(found.tried))


def on_sensors(
    residuals: WhitenedResiduals, cause: SensorCause, sensors: Sequence[int], nonlinear: tuple[float, ...]
) -> Array:
    """(R, m, k) m/s² (rad/s) per unit amplitude: a cause on each of k sensors."""
    setting = residuals.baseline.setting
    return np.concatenate([cause.placed(setting, i, nonlinear) for i in sensors], axis=-1)
