"""Every cause as lasting since the history, as new since then, or with the sensor's own move left open: its traces."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import numpy as np

from estimator.causes import Setting, Shape, Signature
from estimator.diagnosis.residuals.whitened import Evidence
from estimator.diagnosis.signatures.scores import INVISIBLE, Traces
from estimator.session import Array

MANY = 16
"""Sensors from which on effects are not tried both as lasting and as new since the history."""


def traces_of(evidence: Evidence, causes: Iterable[Signature]) -> list[Traces]:
    """Traces of every available cause, in their order."""
    setting = evidence.baseline.setting
    found = []
    for cause in causes:
        if not cause.available(setting) or (cause.between and evidence.between is None):
            continue
        shapes = tuple(cause.shapes(setting))
        if shapes:
            found.extend(_all_traces(evidence, cause, shapes))
    return found


def _all_traces(evidence: Evidence, cause: Signature, shapes: tuple[Shape, ...]) -> list[Traces]:
    """Traces of one cause. With history: as lasting since then, as new, and with the sensor's own move left open.

    In a block of many sensors the versions would cost gigabytes: there an effect is taken as lasting, and what it
    moved if it is new shows as the sensors' drift.
    """
    if cause.between or cause.nameless or evidence.between is None:
        return [_version(evidence, cause, shapes, lasting=not cause.between)]
    lasting = _version(evidence, cause, shapes, lasting=True)
    if len(evidence.baseline.unstated) > MANY:
        return [lasting]
    versions = [lasting, _version(evidence, cause, shapes, lasting=False), freed(evidence, lasting)]
    return [v for v in versions if v is not None]


def _version(evidence: Evidence, cause: Signature, shapes: tuple[Shape, ...], *, lasting: bool) -> Traces:
    """Traces of all shapes of a cause that either lasts since the history or is new.

    What lasts and this session does not show is not told from how differently the sessions absorbed it.
    """
    q = shapes[0].columns.shape[-1]
    stacked = np.concatenate([s.columns for s in shapes], axis=-1)
    trace = evidence.trace(stacked, before(evidence, cause, shapes) if lasting else 0.0)
    raw = np.linalg.norm(evidence.raw(stacked), axis=0)
    if lasting:
        trace[evidence.readings :, np.linalg.norm(trace[: evidence.readings], axis=0) <= INVISIBLE * raw] = 0.0
    columns, raw = np.moveaxis(trace.reshape(len(trace), len(shapes), q), 1, 0), raw.reshape(len(shapes), q)
    shown = (np.linalg.norm(columns, axis=1) > INVISIBLE * raw) & (raw > 0)
    return Traces(cause, shapes, (lasting,) * len(shapes), columns, raw, int(shown.any(axis=-1).sum()))


def before(
    evidence: Evidence, cause: Signature, shapes: Sequence[Shape], of: Callable[[Setting, Shape], Array] | None = None
) -> Array | None:
    """(P, S·q) what the history's calibrations absorbed of the same effects; None where that cannot be told.

    It is told on a stand, of causes of one sensor that may act in every session at every row. ``of``: the columns of
    a shape in a session, where they are not the cause's own.
    """
    between = evidence.between
    if between is None or cause.nameless or not shapes[0].sensors or "row" in cause.nonlinear_units:
        return None
    taken = np.zeros((len(between.deviation), 1))
    for past in between.past:
        setting = replace(past.evidence.baseline.setting, parameters=evidence.baseline.parameters)
        if setting.beta is None or not cause.available(setting):
            return None
        columns = np.concatenate([(of or cause.columns)(setting, shape) for shape in shapes], axis=-1)
        taken = taken + past.weight @ (past.evidence.absorb @ past.evidence.raw(columns))
    return taken


def freed(evidence: Evidence, traces: Traces) -> Traces | None:
    """The same with the sensor's move since the history left open; None for causes of no sensor.

    An effect that some of the history had too, at other temperatures or positions, moves the sensor's parameters by
    an amount that only a diagnosis of every earlier session would tell.
    """
    assert evidence.between is not None
    if not traces.shapes[0].sensors:
        return None
    S, n, _ = traces.columns.shape
    own = np.zeros((S, n, 5))
    for k, shape in enumerate(traces.shapes):
        moved = slice(5 * shape.sensors[0], 5 * shape.sensors[0] + 5)
        own[k, evidence.readings :] = evidence.between.response[:, moved]
    blank = np.zeros((*traces.shapes[0].columns.shape[:2], 5))
    shapes = tuple(Shape(s.sensors, np.concatenate([s.columns, blank], axis=-1), s.nonlinear) for s in traces.shapes)
    raw = np.concatenate([traces.raw, np.zeros((S, 5))], axis=-1)
    return replace(traces, shapes=shapes, columns=np.concatenate([traces.columns, own], axis=-1), raw=raw)
