"""The traces of every cause: as lasting since the history, as new since then, or with the sensor's change left open."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import numpy as np

from estimator.causes.contract import Setting, Shape, Signature
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.diagnosis.signatures.products import Products
from estimator.diagnosis.signatures.traces import INVISIBLE, Traces
from estimator.session import Array

MANY = 16
"""Sensors from which on effects are not tried both as lasting and as new: their traces would take gigabytes."""


def traces_of(residuals: WhitenedResiduals, causes: Iterable[Signature]) -> list[Traces]:
    """Traces of every available cause, in their order."""
    setting = residuals.baseline.setting
    found = []
    for cause in causes:
        if not cause.available(setting) or (cause.between and residuals.change is None):
            continue
        shapes = tuple(cause.shapes(setting))
        if shapes:
            found.extend(_hypotheses(residuals, cause, shapes))
    return found


def _hypotheses(residuals: WhitenedResiduals, cause: Signature, shapes: tuple[Shape, ...]) -> list[Traces]:
    """Traces of one cause. With history: as lasting since then, as new, and with the sensor's own change left open.

    In a block of many sensors an effect is taken as lasting, and what it moved if it is new shows as drift.
    """
    if cause.between or cause.nameless or residuals.change is None:
        return [_traces(residuals, cause, shapes, lasting=not cause.between)]
    lasting = _traces(residuals, cause, shapes, lasting=True)
    if len(residuals.baseline.unstated) > MANY:
        return [lasting]
    new = _traces(residuals, cause, shapes, lasting=False)
    return [lasting, new] if lasting.common else [lasting, new, with_open_change(residuals, lasting)]


def _traces(residuals: WhitenedResiduals, cause: Signature, shapes: tuple[Shape, ...], *, lasting: bool) -> Traces:
    """Traces of all shapes of a cause that either lasts since the history or is new.

    What lasts and this session does not show is not told from how differently the sessions absorbed it.
    """
    q = shapes[0].columns.shape[-1]
    white = residuals.whitened(np.concatenate([s.columns for s in shapes], axis=-1))
    trace = residuals.left_of(white, absorbed_before(residuals, cause, shapes) if lasting else 0.0)
    raw = lengths(white)
    if lasting and residuals.change is not None:
        trace[residuals.rows :, lengths(trace[: residuals.rows]) <= INVISIBLE * raw] = 0.0
    columns, raw = np.moveaxis(trace.reshape(len(trace), len(shapes), q), 1, 0), raw.reshape(len(shapes), q)
    shown = (lengths(trace).reshape(raw.shape) > INVISIBLE * raw) & (raw > 0)
    places, products = int(shown.any(axis=-1).sum()), Products.of(residuals, columns)
    return Traces(cause, shapes, (lasting,) * len(shapes), columns, raw, places, products)


def lengths(rows: Array) -> Array:
    """(q,) norms of columns (n, q), in their unit."""
    return np.sqrt(np.einsum("nq,nq->q", rows, rows))


def absorbed_before(
    residuals: WhitenedResiduals,
    cause: Signature,
    shapes: Sequence[Shape],
    columns_of: Callable[[Setting, Sequence[Shape]], Array] | None = None,
) -> Array | None:
    """(P, S·q) dimensionless: what the history's calibrations absorbed of the same effects; None if that is unknown.

    It is known on a stand, of causes of one sensor that may act in every session at every row. ``columns_of``: the
    columns (R, m, S·q) of the shapes in a session, m/s² (rad/s), where they are not the cause's own.
    """
    change = residuals.change
    if change is None or cause.nameless or not shapes[0].sensors or "row" in cause.nonlinear_units:
        return None
    absorbed = np.zeros((len(change.deviation), 1))
    for earlier in change.earlier:
        setting = replace(earlier.residuals.baseline.setting, parameters=residuals.baseline.parameters)
        if setting.beta is None or not cause.available(setting):
            return None
        columns = (columns_of or cause.all_columns)(setting, shapes)
        absorbed = absorbed + earlier.share @ (earlier.residuals.response @ earlier.residuals.whitened(columns))
    return absorbed


def with_open_change(residuals: WhitenedResiduals, traces: Traces) -> Traces:
    """Traces of a sensor's cause, five columns appended that leave open how its parameters changed since the history.

    An effect that some of the history had too, at other temperatures or positions, moves the sensor's parameters by
    an amount that only a diagnosis of every earlier session would tell.
    """
    assert residuals.change is not None
    (S, n, q), P = traces.columns.shape, len(residuals.change.deviation)
    rows = np.zeros((n, S, q + 5))
    rows[..., :q] = np.moveaxis(traces.columns, 1, 0)
    rows[n - P :, :, q:] = residuals.change.inverse_root.reshape(P, -1, 5)[:, traces.sensor]
    columns = np.moveaxis(rows, 0, 1)
    blank = np.zeros((*traces.shapes[0].columns.shape[:2], 5))
    shapes = tuple(Shape(s.sensors, np.concatenate([s.columns, blank], axis=-1), s.nonlinear) for s in traces.shapes)
    raw = np.concatenate([traces.raw, np.zeros((S, 5))], axis=-1)
    products = traces.products.continued(columns[:, n - P :], residuals.z[n - P :])
    return replace(traces, shapes=shapes, columns=columns, raw=raw, products=products)
