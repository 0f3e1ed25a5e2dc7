"""Shapes between the points of the grid: where a term explains most, and how well the session determines it there."""

from dataclasses import replace

import numpy as np

from estimator.causes.contract import SensorCause, Shape
from estimator.diagnosis.posterior.information import InputInformation
from estimator.diagnosis.posterior.sensor_causes import SensorCauses
from estimator.diagnosis.posterior.term import Term
from estimator.session import Array

STEP = 1e-3
"""Relative step of a shape parameter by which its derivative is taken."""

VAGUE = 2.0
"""Sigmas of its own below which no amplitude is known once the shape is free: then the session does not determine it.
"""

FAINT = 1e-9
"""Share of the largest eigenvalue of a correlation matrix below which a direction is rounding."""


def refined(single: SensorCauses, info: InputInformation, term: Term) -> Term:
    """The term at the shape that is likeliest beside what ``info`` holds: the top of a parabola through the best of its
    neighbours; as it is where no shape is continuous."""
    near = neighbours(single, term)
    if not near:
        return term

    def at(nonlinear: tuple[float, ...]) -> tuple[float, Term]:
        assert term.effect is not None
        columns = columns_of(single, term, nonlinear)
        moved = replace(term, columns=columns, effect=replace(term.effect, nonlinear=nonlinear))
        return info.given(columns, term.variance)[1], moved

    tried = [at(nonlinear) for nonlinear in near]
    best = int(np.argmax([value for value, _ in tried]))
    if 0 < best < len(near) - 1:
        before, top, after = (tried[k][0] for k in (best - 1, best, best + 1))
        step = 0.5 * (before - after) / min(before - 2 * top + after, -1e-300)
        apart = np.log(near[best + 1]) - np.log(near[best - 1])
        tried.append(at(tuple((np.array(near[best]) * np.exp(step * apart / 2)).tolist())))
    known = info.given(term.columns, term.variance)[1], term
    return max([known, *tried], key=lambda pair: pair[0])[1]


def neighbours(single: SensorCauses, term: Term) -> list[tuple[float, ...]]:
    """Shape parameters beside those of a term; none where its shape is not continuous."""
    effect, layout = term.effect, single.layout
    if effect is None or not isinstance(effect.cause, SensorCause):
        return []
    shape = Shape(term.sensors[:1], np.zeros((layout.R, layout.m, 1)), effect.nonlinear)
    return [s.nonlinear for s in effect.cause.neighbours(single.residuals.baseline.setting, shape)]


def columns_of(single: SensorCauses, term: Term, nonlinear: tuple[float, ...]) -> Array:
    """(D, q) the columns of a term at other shape parameters."""
    effect = term.effect
    assert effect is not None
    if len(term.sensors) == 1:
        return single.columns_at(effect, term.sensors[0], nonlinear, effect.scale)
    scales = zip(term.sensors, effect.scale[:, None], strict=True)
    return np.concatenate([single.columns_at(effect, i, nonlinear, scale) for i, scale in scales], axis=1)


def bent(single: SensorCauses, info: InputInformation, term: Term) -> Array | None:
    """(D,) change of the whole effect with the logarithm of its shape parameter, at the likeliest amplitudes; None
    where no shape is free, or the session does not determine it."""
    if not neighbours(single, term):
        return None
    effect = term.effect
    assert effect is not None
    above, below = (
        columns_of(single, term, tuple(x * float(np.exp(step)) for x in effect.nonlinear)) for step in (STEP, -STEP)
    )
    gram = term.columns.T @ info.A @ term.columns
    amplitude = np.linalg.solve(np.diag(1 / term.variance) + gram, term.columns.T @ info.a)
    moved = (above - below) @ amplitude / (2 * STEP)
    value, sigma = estimated(info, np.column_stack([term.columns, moved]))
    own = slice(0, len(effect.scale))
    return None if np.all(np.abs(value[own]) < VAGUE * sigma[own]) else np.asarray(moved)


def estimated(info: InputInformation, columns: Array) -> tuple[Array, Array]:
    """(q,) least squares of the amplitudes of columns (D, q), and (q,) their sigmas."""
    square = columns.T @ info.A @ columns
    norm = np.sqrt(np.maximum(np.diagonal(square), 1e-300))
    covariance = np.linalg.pinv(square / norm[:, None] / norm, hermitian=True, rcond=FAINT) / norm[:, None] / norm
    return covariance @ (columns.T @ info.a), np.sqrt(np.maximum(np.diagonal(covariance), 0.0))
