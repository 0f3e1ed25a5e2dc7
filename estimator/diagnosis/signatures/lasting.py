"""The traces of every cause: as lasting since the history, as new since then, or with the sensor's change left open."""

from collections.abc import Callable, Hashable, Iterable, Sequence
from dataclasses import fields, replace

import numpy as np

from estimator.causes.contract import SensorCause, Setting, Shape, Signature
from estimator.content import held, once
from estimator.diagnosis.residuals.whitened import ParameterChange, WhitenedResiduals
from estimator.diagnosis.signatures.products import Nuisance, Products
from estimator.diagnosis.signatures.traces import INVISIBLE, Traces, sensors_of
from estimator.session import Array

MANY = 16
"""Sensors from which on effects are not tried both as lasting and as new: their traces would take gigabytes."""

RECORDED = frozenset({"time", "temperature", "vibration"})
"""Needs of a cause that differ between sessions of one schedule."""
NOT_SEEN = RECORDED | {"parameters"}
"""Attributes of a setting that do not tell earlier sessions apart: all are seen at the present parameters."""


def traces_of(residuals: WhitenedResiduals, causes: Iterable[Signature]) -> list[Traces]:
    """Traces of every available cause, in their order."""
    setting = residuals.baseline.setting
    traces = []
    for cause in causes:
        if not cause.available(setting) or (cause.between and residuals.change is None):
            continue
        shapes = tuple(cause.shapes(setting))
        if shapes:
            traces.extend(_hypotheses(residuals, cause, shapes))
    return traces


def _hypotheses(residuals: WhitenedResiduals, cause: Signature, shapes: tuple[Shape, ...]) -> list[Traces]:
    """Traces of one cause. With history: as lasting since then, as new, and with the sensor's own change left open.

    In a block of many sensors an effect is taken as lasting, and what it moved if it is new shows as drift.
    """
    lasts = not cause.between
    white = residuals.whitened(np.concatenate([s.columns for s in shapes], axis=-1))
    first = _traces(residuals, cause, shapes, white, lasting=lasts)
    if not lasts or cause.nameless or residuals.change is None or len(residuals.baseline.unstated) > MANY:
        return [first]
    new = as_new(residuals, first, white)
    return [first, new] if first.common else [first, new, with_open_change(residuals, first)]


def _traces(
    residuals: WhitenedResiduals, cause: Signature, shapes: tuple[Shape, ...], white: Array, *, lasting: bool
) -> Traces:
    """Traces of all shapes of a cause, `whitened` to (N, S·q), that either lasts since the history or is new.

    What lasts and this session does not show cannot be inferred from how differently the sessions absorbed it.
    """
    trace = residuals.remaining_of(white, absorbed_before(residuals, cause, shapes) if lasting else 0.0)
    raw = lengths(white)
    if lasting and residuals.change is not None:
        trace[residuals.rows :, lengths(trace[: residuals.rows]) <= INVISIBLE * raw] = 0.0
    columns, raw = trace.reshape(len(trace), len(shapes), -1).swapaxes(0, 1), raw.reshape(len(shapes), -1)
    products, whence = Products.of(residuals, columns), ((lasting,) * len(shapes), sensors_of(shapes))
    return Traces(cause, shapes, *whence, columns, raw, visible(products, raw), products)


def visible(products: Products, raw: Array) -> int:
    """Number of shapes that show, by products of their traces and their length before, raw (S, q), standard errors."""
    square = np.diagonal(products.whole[0], axis1=1, axis2=2)
    return int(((square > (INVISIBLE * raw) ** 2) & (raw > 0)).any(axis=-1).sum())


def as_new(residuals: WhitenedResiduals, lasting: Traces, white: Array) -> Traces:
    """The traces of a cause that lasts, `whitened` to (N, S·q), as of one that is new: all that it moves changed."""
    assert residuals.change is not None
    N, z = residuals.rows, residuals.z
    S, n, q = lasting.columns.shape
    rows = lasting.columns.swapaxes(0, 1).copy()
    rows[N:] = (residuals.change.inverse_root @ (residuals.response @ white)).reshape(n - N, S, q)
    columns = rows.swapaxes(0, 1)
    products = lasting.products.continued(columns[:, N:], z[N:])
    places = visible(products, lasting.raw)
    return replace(lasting, lasting=(False,) * S, columns=columns, places=places, products=products)


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

    It is known on a stand, of causes of one sensor that may act in every session at every row; in orientations of what
    settles after switching on, which depends on nothing but the time. ``columns_of``: the columns (R, m, S·q) of the
    shapes in a session, m/s² (rad/s), where they are not the cause's own.
    """
    change = residuals.change
    if change is None or cause.nameless or not shapes[0].sensors or "row" in cause.nonlinear_units:
        return None
    absorbed = np.zeros((len(change.deviation), 1))
    for setting, absorbs in alike(change, RECORDED if columns_of else RECORDED & cause.needs):
        if (setting.beta is None and not cause.since_power_on) or not cause.available(setting):
            return None
        if columns_of is None and isinstance(cause, SensorCause):
            each = [absorbed_terms(absorbs[:, :, i], terms) for i, terms in cause.terms_of(setting, shapes)]
            absorbed = absorbed + np.concatenate(each, axis=1)
        else:
            columns = (columns_of or cause.all_columns)(setting, shapes)
            rows = columns.shape[0] * columns.shape[1]
            absorbed = absorbed + absorbs.reshape(-1, rows) @ columns.reshape(rows, -1)
    return absorbed


@once
def alike(change: ParameterChange, recorded: frozenset[str]) -> tuple[tuple[Setting, Array], ...]:
    """Settings of the history that differ for a cause that looks at nothing ``recorded`` but this, each with what all
    sessions in it absorb: (P, R, m) per m/s² (rad/s). A signature at one's parameters depends on nothing else."""
    groups: dict[Hashable, tuple[Setting, Array]] = {}
    for earlier in change.earlier:
        setting = earlier.setting
        seen = [
            getattr(setting, attribute.name)
            for attribute in fields(setting)
            if attribute.name not in NOT_SEEN - recorded
        ]
        key = held(seen)
        absorbed = groups[key][1] + earlier.absorbs if key in groups else earlier.absorbs
        groups[key] = setting, absorbed
    return tuple(groups.values())


def absorbed_terms(absorbs: Array, terms: Array) -> Array:
    """(P, S·q) dimensionless: what a session absorbs, (P, R) of one sensor, per m/s², of terms (S, R, q), m/s²."""
    return np.asarray(absorbs @ terms.swapaxes(0, 1).reshape(terms.shape[1], -1))


def with_open_change(residuals: WhitenedResiduals, traces: Traces) -> Traces:
    """Traces of a sensor's cause, five columns appended that leave open how its parameters changed since the history.

    An effect that some of the history had too, at other temperatures or positions, moves the sensor's parameters by
    an amount that only a diagnosis of every earlier session would tell.
    """
    assert residuals.change is not None
    N, P = residuals.rows, len(residuals.change.deviation)
    nuisance = Nuisance(residuals.change.inverse_root.reshape(P, -1, 5).swapaxes(0, 1), traces.sensor)
    raw = np.concatenate([traces.raw, np.zeros((len(traces.raw), 5))], axis=-1)
    change = np.concatenate([traces.columns[:, N:], nuisance.each], axis=-1)
    return replace(traces, raw=raw, products=traces.products.continued(change, residuals.z[N:]), nuisance=nuisance)
