"""The one shape of a course that sensors share: its nonlinear parameters beside a size of each, and who has his own.

Theory
------
With sizes k_i (k,) and traces X(ψ) (n, k) of the sensors side by side, what the course explains is T(ψ) = |X̂(ψ)'z|²,
X̂ orthonormal: ψ is where it is largest. About it the effect is linear in the sizes and in ψ,

    Σ k_i X_i(ψ̂) + δψ·Σ k̂_i ∂X_i/∂ψ

one column more for all sensors together, so that ψ has an uncertainty and every size that of ψ in it.

Against it every sensor may have a shape of its own, each of those that are tried as likely beforehand as for all. With
T_i(ψ) what a sensor's own trace explains beside those of the others at ψ̂, they share one shape where

    ln mean_ψ exp ½w[T(ψ) − T(ψ̂)] − Σ_i ln mean_ψ exp ½w[T_i(ψ) − T_i(ψ̂)] > −ln 100,        w = g/(1 + g)

with sizes N(0, g): the ln of the Bayes factor. Below that bound they are apart; between it and ln 100 the session does
not decide, so that one misfortune is likelier than many, and it is said that each may have its own. No share of the
sensors decides, and no strong few: a weak one that fits ill speaks against it as loudly as it can.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from estimator.causes.contract import SensorCause, Setting, Shape
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.diagnosis.selection.search_state import NEW_DIRECTION
from estimator.diagnosis.signatures.lasting import absorbed_before
from estimator.diagnosis.signatures.traces import Scored
from estimator.diagnosis.signatures.wandering import log_mean
from estimator.least_squares import FAINT, least_squares, orthonormal
from estimator.session import Array

APART = float(-np.log(100))
"""ln Bayes factor below which each sensor has a shape of its own: one in a hundred shared courses at most is below."""

VAGUE = 2.0
"""Sigmas of its own below which no size is known once ψ is free: then the session does not determine ψ."""


def at(cause: SensorCause, setting: Setting, sensors: Sequence[int], nonlinear: tuple[float, ...]) -> list[Shape]:
    """The shapes of some sensors with the same nonlinear parameters."""
    return [Shape((i,), cause.placed(setting, i, nonlinear), nonlinear) for i in sensors]


def traces_at(residuals: WhitenedResiduals, cause: SensorCause, shapes: Sequence[Shape], *, lasting: bool) -> Array:
    """(n, k) standard errors per unit amplitude: what the shapes of k sensors leave, side by side."""
    before = absorbed_before(residuals, cause, shapes) if lasting else 0.0
    return residuals.trace(np.concatenate([s.columns for s in shapes], axis=-1), before)


def explained(columns: Array, z: Array, attributed: Array) -> float:
    """T of columns (n, k) in residuals z (n,), both standard errors, beside ``attributed`` (n, f), orthonormal."""
    new = columns - attributed @ (attributed.T @ columns)
    return float(((orthonormal(new, NEW_DIRECTION).T @ z) ** 2).sum())


def at_its_best(
    residuals: WhitenedResiduals,
    cause: SensorCause,
    sensors: Sequence[int],
    known: Shape,
    attributed: Array,
    *,
    lasting: bool,
) -> tuple[list[Shape], Array]:
    """The shapes of sensors with the nonlinear parameter near the ``known`` one that explains most beside
    ``attributed`` (n, f), and their traces (n, k): the top of a parabola through the best that were tried. None where
    nothing is continuous."""

    def tried(nonlinear: tuple[float, ...]) -> tuple[float, list[Shape], Array]:
        shapes = at(cause, residuals.baseline.setting, sensors, nonlinear)
        columns = traces_at(residuals, cause, shapes, lasting=lasting)
        return explained(columns, residuals.z, attributed), shapes, columns

    near = [shape.nonlinear for shape in cause.neighbours(residuals.baseline.setting, known)]
    if not near:
        return [], np.zeros((len(residuals.z), 0))
    each = [tried(nonlinear) for nonlinear in near]
    best = int(np.argmax([value for value, _, _ in each]))
    if 0 < best < len(near) - 1:
        before, top, after = (each[k][0] for k in (best - 1, best, best + 1))
        step = 0.5 * (before - after) / min(before - 2 * top + after, -1e-300)
        ahead, behind = np.log(near[best + 1]), np.log(near[best - 1])
        between = np.asarray(near[best] * np.exp(step * (ahead - behind) / 2)).tolist()
        each.append(tried(tuple(between)))
    return max(each, key=lambda one: one[0])[1:]


def refined_together(residuals: WhitenedResiduals, members: Sequence[Scored], attributed: Array) -> list[Scored]:
    """Sensors of a course with their shape moved to its best, its derivative appended to the first one's.

    ``attributed`` (n, f) orthonormal traces of other findings, dimensionless. As they are where nothing is continuous.
    """
    cause, setting = members[0].cause, residuals.baseline.setting
    assert isinstance(cause, SensorCause)
    sensors, lasting = [s.sensors[0] for s in members], members[0].lasting
    shapes, columns = at_its_best(
        residuals, cause, sensors, members[0].shape.first(len(cause.units)), attributed, lasting=lasting
    )
    if not shapes:
        return list(members)
    each = [
        replace(s, shape=shape, trace=columns[:, k : k + 1])
        for k, (s, shape) in enumerate(zip(members, shapes, strict=True))
    ]
    sizes = size_of(columns, residuals.z, attributed)
    bent = np.concatenate([cause.derivative(setting, shape) for shape in shapes], axis=-1) @ sizes
    moved = bent_trace(residuals, cause, shapes, sizes, lasting=lasting)
    if is_vague(np.column_stack([columns, moved]), residuals.z, attributed):
        return each
    first = replace(shapes[0], columns=np.concatenate([shapes[0].columns, bent[..., None]], axis=-1))
    return [replace(each[0], shape=first, trace=np.column_stack([columns[:, 0], moved])), *each[1:]]


def bent_trace(
    residuals: WhitenedResiduals, cause: SensorCause, shapes: Sequence[Shape], sizes: Array, *, lasting: bool
) -> Array:
    """(n,) trace of the change of the whole effect with its nonlinear parameter, standard errors; ``sizes`` (k,)."""

    def derivative(where: Setting, members: Sequence[Shape]) -> Array:
        """(R, m, k) m/s² (rad/s)."""
        there = [replace(s, columns=cause.columns(where, s)) for s in members]
        return np.concatenate([cause.derivative(where, s) for s in there], axis=-1)

    before = absorbed_before(residuals, cause, shapes, derivative) if lasting else 0.0
    whole = before @ sizes[:, None] if isinstance(before, np.ndarray) else before
    columns = derivative(residuals.baseline.setting, shapes) @ sizes[:, None]
    return residuals.trace(columns, whole)[:, 0]


def size_of(columns: Array, z: Array, attributed: Array) -> Array:
    """(k,) amplitudes of traces (n, k) beside ``attributed`` (n, f), orthonormal."""
    return least_squares(columns - attributed @ (attributed.T @ columns), z, FAINT).value


def is_vague(columns: Array, z: Array, attributed: Array) -> bool:
    """Whether no size is known once the last of columns (n, k + 1), that of the shape, is free."""
    fit = least_squares(columns - attributed @ (attributed.T @ columns), z, FAINT)
    sigma = np.sqrt(np.diagonal(fit.covariance)[:-1])
    return bool(np.all(np.abs(fit.value[:-1]) < VAGUE * sigma))


def powers(z: Array, traces: Array, beside: Array) -> Array:
    """(S,) T of each of traces (n, S) by itself in residuals z (n,), standard errors, given ``beside`` (n, k)."""
    basis = orthonormal(beside, NEW_DIRECTION) if beside.shape[1] else np.zeros((len(z), 0))
    new = traces - basis @ (basis.T @ traces)
    length = np.maximum((new**2).sum(axis=0), NEW_DIRECTION * (traces**2).sum(axis=0))
    return np.asarray((z @ new) ** 2 / np.where(length > 0, length, 1.0))


def log_shared(together: Array, shared: float, apart: Sequence[Array], own: Sequence[float]) -> float:
    """ln Bayes factor of one shape for all against one for each, sizes being N(0, g) with g as the sensors show it.

    ``together`` (S,) T of all at every shape, ``shared`` at that which all have; ``apart``, ``own``: T_i, the same of
    every sensor.
    """
    g = max(float(np.mean(own)) - 1.0, 1.0)
    each = [log_mean(0.5 * g / (1 + g) * (values - known)) for values, known in zip(apart, own, strict=True)]
    return log_mean(0.5 * g / (1 + g) * (together - shared)) - sum(each)
