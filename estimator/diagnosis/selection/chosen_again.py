"""Naming may not predict worse: causes and shapes are chosen again from every fold's other rows, and must predict it.

A name chosen with the help of the very rows that it is judged by always seems to help. So in every fold each finding
is chosen anew among the leaders of its ranking, with all their shapes, from the rows that are not held out. Sizes of
sensors that share a course are N(0, g) there as where it was found, g of the same rows: many sizes, each of which is
hardly known, predict well together, and ill as if each could be anything.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from estimator.causes.contract import Shape
from estimator.causes.shared import SharedCourse
from estimator.content import once
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.prediction import FOLDS, Prediction, fold_of, predicted, predicted_without_effects
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.diagnosis.selection.chosen_together import shapes_together, units, without_formula
from estimator.diagnosis.selection.forward import with_structures
from estimator.diagnosis.selection.ranking import extended_basis
from estimator.diagnosis.selection.search_state import NEW_DIRECTION, Detection, SearchState
from estimator.diagnosis.signatures.scores import bayes_factor
from estimator.diagnosis.signatures.traces import Traces
from estimator.session import Array

LEADERS = 6
"""Causes of a ranking among which one is chosen again: those behind are less likely by orders of magnitude."""

WORSE = 2.0
"""ln of the odds by which a prediction must be worse: less is the chance of which row lies in which fold."""

WITHIN = 0.5
"""Share of a finding's energy that the session's own rows must hold, and that no fold may hold, for its prediction of
rows to be judged."""


def without_unpredictive(state: SearchState) -> SearchState:
    """The state without its names where they, chosen again in every fold, predict the rows held out worse than none.

    What they explained is then structure; where no pattern holds it, as it is.
    """
    judged = [f for unit in units(state.detections) if predicts(state, unit) for f in unit]
    if not judged:
        return state
    nothing = predicted_without_effects(state.baseline)
    named = predicted_from_folds(state, judged)
    known = not state.baseline.unstated.any()
    gained = named.log_score - nothing.log_score if known else named.scale_free - nothing.scale_free
    if gained > -WORSE:
        return state
    rest = with_structures(replace(state, detections=tuple(f for f in state.detections if f not in judged)))
    return rest if rest.structures else replace(rest, structures=tuple(judged))


def predicts(state: SearchState, unit: Sequence[Detection]) -> bool:
    """Whether a finding, or all findings of one course together, predicts rows by which it was not chosen.

    It does not where it shows in what changed since the history rather than in the session's own rows, nor where a fold
    holds most of what shows of it: without those rows nobody could know.
    """
    if unit[0].best.cause.between:
        return False
    rows, m = state.baseline.setting.rows, state.sensor_count
    basis, _ = np.linalg.qr(np.concatenate([f.best.trace for f in unit], axis=1))
    fitted = (basis @ (basis.T @ state.residuals.z)) ** 2
    each = fitted[: rows * m].reshape(rows, m).sum(axis=1)
    by_fold = np.bincount(fold_of(rows), weights=each)
    return bool(each.sum() > WITHIN * fitted.sum() and by_fold.max() < WITHIN * each.sum())


def predicted_from_folds(state: SearchState, judged: Sequence[Detection]) -> Prediction:
    """Every row predicted by the causes of some findings, chosen again in the folds that do not hold it."""
    return _predicted(state.residuals, state.traces, tuple(judged))


@once
def _predicted(residuals: WhitenedResiduals, traces: tuple[Traces, ...], judged: tuple[Detection, ...]) -> Prediction:
    chosen = chosen_in_folds(residuals, traces, judged)
    return predicted(residuals.baseline, chosen, spreads(residuals, judged, chosen))


def spreads(
    residuals: WhitenedResiduals, judged: Sequence[Detection], chosen: Sequence[Sequence[Array]]
) -> list[Array]:
    """(Q,) standard deviations of the amplitudes of the columns, fold by fold; the amplitude of a lone finding is
    unknown.
    """
    found = []
    for rest, columns in zip(without_folds(residuals.baseline), chosen, strict=True):
        of_units = zip(units(judged), columns, strict=True)
        each = [spread(residuals, rest, c) if len(u) > 1 else np.full(c.shape[-1], np.inf) for u, c in of_units]
        found.append(np.concatenate([np.zeros(0), *each]))
    return found


def spread(residuals: WhitenedResiduals, rest: "Rest", columns: Array) -> Array:
    """(q,) standard deviations of amplitudes of columns (R, m, q) whose squares, in standard errors, have one mean."""
    rows = residuals.whitened(columns)[rest.remaining]
    trace = rows - rest.basis @ (rest.basis.T @ rows)
    size = np.maximum(np.linalg.norm(trace, axis=0), 1e-300)
    g = max(float(np.mean((rest.z @ trace / size) ** 2)) - 1.0, 1.0)
    return np.asarray(np.sqrt(g) / size)


def chosen_in_folds(
    residuals: WhitenedResiduals, traces: Sequence[Traces], judged: Sequence[Detection]
) -> list[list[Array]]:
    """The columns (R, m, q), m/s² (rad/s), of the causes chosen without a fold's rows, for every fold."""
    found = [(unit, candidates(residuals, traces, unit)) for unit in units(judged)]
    chosen = []
    for rest in without_folds(residuals.baseline):
        basis, z, columns = rest.basis, rest.z, []
        for unit, known in found:
            columns.append(chosen_from(residuals, known, unit, Rest(rest.remaining, basis, z)))
            basis = extended_basis(basis, residuals.whitened(columns[-1])[rest.remaining])
            z = z - basis @ (basis.T @ z)
        chosen.append(columns)
    return chosen


@dataclass(frozen=True, eq=False)
class Candidates:
    """Shapes among which a finding is chosen again."""

    columns: tuple[Array, ...]
    """(R, m, q) each, m/s² (rad/s)."""
    price: tuple[float, ...]
    """ln of the number of shapes that share the prior of each one's cause."""
    whitened: tuple["Alike", ...]


def candidates(residuals: WhitenedResiduals, traces: Sequence[Traces], unit: Sequence[Detection]) -> Candidates:
    """The candidates for a finding, or for all findings of one course."""
    if len(unit) > 1 and not isinstance(unit[0].best.cause, SharedCourse):
        priced = list(shapes_together(traces, unit, LEADERS))
    elif len(unit) > 1:
        priced = []
    else:
        priced = [(shape.columns, price) for shape, price in shapes_of(traces, unit[0])]
    columns = tuple(each for each, _ in priced)
    return Candidates(columns, tuple(price for _, price in priced), tuple(alike(residuals, columns)))


def chosen_from(residuals: WhitenedResiduals, known: Candidates, unit: Sequence[Detection], rest: "Rest") -> Array:
    """(R, m, q) m/s² (rad/s): the shape that is likeliest by the rows left."""
    fitted = list(without_formula(residuals, unit, rest.remaining, rest.basis, rest.z)) if not known.columns else []
    if fitted:
        return fitted[0][0]
    weight = np.empty(len(known.columns))
    for group in known.whitened:
        weight[group.number] = weights(rest.basis, rest.z, group.columns[:, rest.remaining])
    return known.columns[int(np.argmax(weight - known.price))]


@dataclass(frozen=True, eq=False)
class Rest:
    """The rows that one fold leaves. N rows in all, n of them left."""

    remaining: Array
    """(N,) bool."""
    basis: Array
    """(n, p) orthonormal, dimensionless: what the baseline absorbs of them."""
    z: Array
    """(n,) standard errors: what it leaves."""


@once
def without_folds(baseline: Baseline) -> tuple[Rest, ...]:
    """The rows of a session that every fold leaves, with the baseline projected out of them."""
    design, (rows, m) = baseline.whitened_design, baseline.residual.shape
    data, fold = np.zeros(len(design)), np.full(len(design), -1)
    data[: rows * m] = baseline.whiten(baseline.residual[..., None])[:, 0]
    fold[: rows * m] = np.repeat(fold_of(rows), m)
    rests = []
    for held in range(FOLDS):
        remaining = fold != held
        basis = extended_basis(np.zeros((int(remaining.sum()), 0)), design[remaining])
        rests.append(Rest(remaining, basis, data[remaining] - basis @ (basis.T @ data[remaining])))
    return tuple(rests)


def shapes_of(every: Sequence[Traces], detection: Detection) -> Iterator[tuple[Shape, float]]:
    """The shapes among which a finding is chosen again, each with the ln of the number that share its cause's prior;
    as lasting and as new it is the same in the rows of the session, and taken once."""
    yield detection.best.shape, float(np.log(max(detection.best.places, 1)))
    leaders = {s.group for s, _ in detection.ranking[:LEADERS]}
    fewest: dict[Shape, int] = {}
    for traces in every:
        for shape in traces.shapes:
            if (traces.cause.identifier, shape.sensors) in leaders and not traces.cause.between:
                fewest[shape] = min(fewest.get(shape, traces.places), traces.places)
    yield from ((shape, float(np.log(max(places, 1)))) for shape, places in fewest.items())


@dataclass(frozen=True, eq=False)
class Alike:
    """Shapes of equally many amplitudes, whitened. S shapes, N rows."""

    number: Array
    """(S,) int, their places among all."""
    columns: Array
    """(S, N, q) standard errors per unit amplitude."""


def alike(residuals: WhitenedResiduals, shapes: Sequence[Array]) -> list[Alike]:
    """Shapes (R, m, q), m/s² (rad/s), whitened, those of equally many amplitudes together."""
    width = np.array([columns.shape[-1] for columns in shapes])
    groups = []
    for q in np.unique(width):
        number = np.flatnonzero(width == q)
        white = residuals.whitened(np.concatenate([shapes[k] for k in number.tolist()], axis=-1))
        groups.append(Alike(number, white.reshape(len(white), -1, q).swapaxes(0, 1)))
    return groups


def spans(columns: Array) -> tuple[Array, Array]:
    """(S, n, q) orthonormal directions of columns (S, n, q), and (S, q) their singular values, dimensionless."""
    if columns.shape[-1] > 1:
        directions, size, _ = np.linalg.svd(columns, full_matrices=False)
        return directions, size
    size = np.linalg.norm(columns, axis=1)
    return columns / np.where(size > 0, size, 1.0)[:, None], size


def weights(basis: Array, z: Array, columns: Array) -> Array:
    """(S,) ln evidence of columns (S, n, q) on what ``basis`` (n, p) leaves of residuals z (n,), standard errors."""
    S, n, q = columns.shape
    rows = columns.swapaxes(0, 1).reshape(n, S * q)
    norms = np.linalg.norm(rows, axis=0)
    new = rows / np.where(norms > 0, norms, 1.0)
    for _ in range(2):  # once leaves rounding of what lies almost within the span
        new = new - basis @ (basis.T @ new)
    directions, size = spans(new.reshape(n, S, q).swapaxes(0, 1))
    live = size > NEW_DIRECTION
    power, freedom = (np.where(live, z @ directions, 0.0) ** 2).sum(axis=1), live.sum(axis=1)
    rest = (float(z @ z) - power) / np.maximum(len(z) - basis.shape[1] - freedom, 1)
    return bayes_factor(power / np.maximum(rest, 1.0), freedom)
