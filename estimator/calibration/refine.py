"""Maximum likelihood on a two-axis stand: Gauss–Newton with the stand's errors inside the weighting.

Theory
------
At the input, the residual of sensor i in row j is

    r_ij = J_ij·δθ_i + Σ_k G_ijk·s_k + h_ij·δβ_j + ε_ij

with s_k the stand's constant errors, δβ_j the row's own error, both normal with stated sigma, and ε independent.
The stand's errors are common to all sensors: δβ_j is marginalised row by row (a rank-one update of the normal matrix),
the s_k are carried as unknowns with their prior. The inverse of the normal matrix is then the total covariance, and
the estimate is the minimum-variance one: six sensors see the same δβ_j and mostly cancel it.

S sessions of one schedule are solved in one call; R rows, m sensors, k constant errors, P = 5 m.
Source: analytic alignment paper (14), (15), with the noise and stand errors of the package page.
"""

from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np

from estimator.applied_vector import Geometry
from estimator.arrays import eigh
from estimator.forward import input_of, jacobian, projected, slope
from estimator.parameters import LIMIT, PLAUSIBLE, SensorParameters
from estimator.session import Array

RIDGE = PLAUSIBLE**-2
"""Information of the plausible range: keeps what a session does not observe where it started."""

FINEST = 1e-8
"""Least one sigma of a reading, as part of the applied vector: no reading is believed beyond it. 0.01 µg is below any
instrument, and keeps readings without noise from straining the arithmetic."""

LONGEST = np.array([1.0, np.inf, 1.0, 1.0, 1.0])
"""Longest step of each element, so that senseless readings lead nowhere rather than to infinity; biases may be many g
(raw counts without a stated offset), and follow from the others."""

MAX_ITERATIONS = 20
"""One or two are usual; what has not converged by then is reported so."""
CONVERGED = 1e-8
"""Squared length of the step still to come, in standard errors and per parameter, that ends the iteration: 1e-4 of a
sigma changes no figure that anyone is shown."""


@dataclass(frozen=True, eq=False)
class RefinedFit:
    """Solution for S sessions of one schedule."""

    parameters: SensorParameters
    """Arrays (S, m)."""
    covariance: Array
    """(S, P, P) total, dimensionless elements."""
    repeatability: Array
    """(S, P, P) without the stand's constant errors, dimensionless elements."""
    information: Array
    """(S, m, 5, 5) each sensor's own information, stand perfect: what observability is judged on."""
    residual: Array
    """(S, R, m) at the input, m/s² (rad/s)."""
    variance: Array
    """(S, R, m) variance of the independent noise at the input, (m/s²)² or (rad/s)²; infinite for readings that take no
    part.
    """
    chi2: Array
    """(S,)"""
    constant: Array
    """(S, k) estimated constant stand errors, rad (s for the count time)."""
    iterations: Array
    """(S,)"""
    converged: Array
    """(S,) bool"""

    @cached_property
    def readings(self) -> Array:
        """(S,) number of readings that take part; those of infinite variance do not."""
        return np.isfinite(self.variance).sum(axis=(1, 2))


@dataclass(frozen=True, eq=False)
class Normal:
    """One linearisation: bordered normal matrix of (θ, s) and the weighted right-hand side."""

    matrix: Array
    """(S, P + k, P + k), dimensionless elements, stand errors in rad (s)."""
    rhs: Array
    """(S, P + k)"""
    weighted_square: Array
    """(S,) r'W r with the β errors marginalised."""
    per_sensor: Array
    """(S, m, 5, 5) information of each sensor alone."""


def assemble(design: Array, weight: Array, beta: Array, beta_sigma: float, prior: Array) -> Normal:
    """Normal matrix of all sensors with the row errors marginalised.

    Parameters
    ----------
    design : (S, R, m, 5 + k + 1) at the input: the Jacobian, the constant errors' columns per rad (s), the residual in
        m/s² (rad/s).
    weight : (S, R, m) inverse variance of the independent noise, 1/(m/s²)² or 1/(rad/s)².
    beta : (S, R, m) effect of the row's β error, m/s² (rad/s) per rad.
    beta_sigma : rad.
    prior : (k,) inverse variance of the constant errors, 1/rad² (1/s²).
    """
    S, R, m, width = design.shape
    P, tail = 5 * m, width - 5
    root = np.sqrt(weight).swapaxes(1, 2)
    white = design.swapaxes(1, 2) * root[..., None]
    gram = white.swapaxes(-1, -2) @ white
    full = np.zeros((S, P + tail, P + tail))
    index = np.arange(m)
    full[:, :P, :P].reshape(S, m, 5, m, 5)[:, index, :, index] = gram[..., :5, :5].swapaxes(0, 1)
    full[:, P:, :P] = gram[..., 5:, :5].swapaxes(1, 2).reshape(S, tail, P)
    full[:, P:, P:] = gram[..., 5:, 5:].sum(axis=1)
    if beta_sigma > 0:
        swing = beta.swapaxes(1, 2) * root
        touched = white * (swing / np.sqrt(beta_sigma**-2 + (swing * swing).sum(axis=1, keepdims=True)))[..., None]
        per_row = np.empty((S, R, P + tail))
        per_row[..., :P].reshape(S, R, m, 5)[...] = touched[..., :5].swapaxes(1, 2)
        touched[..., 5:].sum(axis=1, out=per_row[..., P:])
        full -= per_row.swapaxes(-1, -2) @ per_row
    full[:, :P, P:] = full[:, P:, :P].swapaxes(-1, -2)
    matrix = full[:, :-1, :-1].copy()
    diagonal = np.arange(P + tail - 1)
    matrix[:, diagonal, diagonal] += np.concatenate([np.full(P, RIDGE), prior])
    return Normal(matrix, full[:, -1, :-1], full[:, -1, -1], gram[..., :5, :5])


def linearise(y: Array, p: SensorParameters, geometry: Geometry, weight: Array) -> tuple[Normal, Array]:
    """Normal equations at p (S, m) and the residual there (S, R, m), m/s² (rad/s).

    y : (S, R, m) readings, offset taken off, reading units; weight : (S, R, m) as in `assemble`, 1/(m/s²)².
    """
    residual = y / p.scale[:, None, :] - input_of(p, geometry.n)
    design, beta = designed(p, geometry, residual)
    return assemble(design, weight, beta, geometry.beta_sigma, geometry.constant_sigma**-2.0), residual


def designed(p: SensorParameters, geometry: Geometry, *more: Array) -> tuple[Array, Array]:
    """Columns (S, R, m, 5 + k + …) of each sensor's own parameters, the constant errors and ``more`` (S, R, m) ones,
    and the answer (S, R, m) to the row's error of β; at the input, m/s² (rad/s) per element, rad or s."""
    k = len(geometry.constant)
    steep = slope(p, geometry.n)
    S, R, m = steep.shape
    design = np.empty((S, m, R, 5 + k + len(more))).swapaxes(1, 2)
    design[..., :5] = jacobian(p, geometry.n, geometry.norm)
    for i, change in enumerate(geometry.constant, start=5):
        design[..., i] = steep * projected(p.axis, change)
    for i, column in enumerate(more, start=5 + k):
        design[..., i] = column
    return design, steep * projected(p.axis, geometry.beta)


def input_variance(p: SensorParameters, standard_errors: Array, repeatability: Array) -> Array:
    """(S, R, m) variance of the independent noise at the input, (m/s²)² or (rad/s)²: (se/K)² + bias repeatability².

    standard_errors : (S, R, m) se, reading units; repeatability : (m,) m/s² (rad/s).
    """
    return (standard_errors / p.scale[:, None, :]) ** 2 + repeatability**2


def eliminated(normal: Normal, P: int, sigma: Array) -> tuple[Array, Array, Array]:
    """Total covariance and repeatability (S, P, P) and the step (S, P + k), with the constant errors eliminated.

    Elements are dimensionless; the constant errors' sigma (k,) is in rad (s).

    With A the sensors' block, B the border and F = A⁻¹B, the readings tell D = G'WG − B'F of the constant errors s
    beyond their prior Π (less what the ridge pretends). Then cov = A⁻¹ + F·(Π + D)⁻¹·F', of which
    F·(Π + D)⁻¹·Π·(Π + D)⁻¹·F' is the stand's. The rest is written as a sum of positive terms: as a difference it would
    drown when the stand is far worse than the readings. D is taken apart in units of Π, so that readings that tell of
    the stand beyond all measure cannot make the sum singular.
    """
    border, prior = normal.matrix[:, :P, P:], np.diag(sigma**-2.0)
    inner = np.linalg.inv(normal.matrix[:, :P, :P])
    lean = inner @ border
    taken = (border + RIDGE * lean).swapaxes(-1, -2) @ lean
    scaled = sigma[:, None] * (normal.matrix[:, P:, P:] - prior - taken) * sigma
    values, vectors = eigh(scaled)
    values = np.maximum(values, 0.0)[:, None, :]
    root = vectors * np.sqrt(values) / sigma[:, None]
    half = vectors * sigma[:, None] / np.sqrt(1.0 + values)
    spread = half @ half.swapaxes(-1, -2)
    gain = lean @ spread
    sensor_rhs, constant_rhs = normal.rhs[:, :P, None], normal.rhs[:, P:, None]
    constant = spread @ (constant_rhs - lean.swapaxes(-1, -2) @ sensor_rhs)
    step = np.concatenate([inner @ sensor_rhs - lean @ constant, constant], axis=1)[..., 0]
    stand_part = gain @ root
    return inner + gain @ lean.swapaxes(-1, -2), inner + stand_part @ stand_part.swapaxes(-1, -2), step


def with_open_directions_held(normal: Normal) -> Normal:
    """The normal equations with each sensor's open directions held where they are.

    Along them the readings say nothing to first order, but a step would change to second order what they do say.
    """
    values, vectors = eigh(normal.per_sensor)
    weak = np.where(values < LIMIT**-2, 1.0, 0.0)
    stiff = values.max(axis=-1, keepdims=True) * weak
    penalty = (vectors * stiff[..., None, :]) @ vectors.swapaxes(-1, -2)
    S, m = penalty.shape[:2]
    stiffness, index = np.zeros((S, m, 5, m, 5)), np.arange(m)
    stiffness[:, index, :, index] = penalty.swapaxes(0, 1)
    matrix = normal.matrix.copy()
    matrix[:, : 5 * m, : 5 * m] += stiffness.reshape(S, 5 * m, 5 * m)
    return replace(normal, matrix=matrix)


def gauss_newton(y: Array, variance: Array, geometry: Geometry, p: SensorParameters, iteration: int) -> RefinedFit:
    """One step from p (S, m), the ``iteration``-th; y and variance (S, R, m) as in `fit`.

    A session has converged when the step still to come, which a step of relative size δ leaves to the order of δ times
    itself, is negligible in standard errors. The covariance is that of the linearisation that gave the step.
    """
    S, _, m = y.shape
    P = 5 * m
    normal, _ = linearise(y, p, geometry, 1.0 / variance)
    total, repeatability, step = eliminated(normal, P, geometry.constant_sigma)
    if np.diagonal(total, axis1=1, axis2=2).max() > LIMIT**2:
        *_, step = eliminated(with_open_directions_held(normal), P, geometry.constant_sigma)
    change = step[:, :P]
    length = (change**2 / np.diagonal(total, axis1=1, axis2=2)).max(axis=-1)
    to_come = length * np.minimum(1.0, 4.0 * (change**2).max(axis=-1))
    moved = p.stepped(np.clip(change.reshape(S, m, 5), -LONGEST, LONGEST), geometry.norm)
    return RefinedFit(
        parameters=moved,
        covariance=total,
        repeatability=repeatability,
        information=normal.per_sensor,
        residual=y / moved.scale[:, None, :] - input_of(moved, geometry.n),
        variance=variance,
        chi2=normal.weighted_square - (normal.rhs * step).sum(axis=-1),
        constant=step[:, P:],
        iterations=np.full(S, iteration),
        converged=to_come < CONVERGED,
    )


def fit(y: Array, variance: Array, geometry: Geometry, start: SensorParameters) -> RefinedFit:
    """Maximum-likelihood parameters of S sessions of one schedule; each iterates until it has converged itself.

    Parameters
    ----------
    y : (S, R, m) readings, offset taken off, reading units (`forward.measured`).
    variance : (S, R, m) of the independent noise at the input, (m/s²)² or (rad/s)²; infinite for readings that take no
        part.
    geometry : of the schedule.
    start : (S, m) starting values; the closed form where there is one.
    """
    variance = np.maximum(variance, (FINEST * geometry.norm) ** 2)
    fitted = gauss_newton(y, variance, geometry, start, 1)
    for iteration in range(2, MAX_ITERATIONS + 1):
        waiting = np.flatnonzero(~fitted.converged)
        if len(waiting) == 0:
            break
        again = gauss_newton(y[waiting], variance[waiting], geometry, fitted.parameters.at(waiting), iteration)
        fitted = with_sessions_replaced(fitted, waiting, again)
    return fitted


def with_sessions_replaced(result: Any, at: Array, again: Any) -> Any:
    """A copy of the result whose sessions ``at`` (k,) are replaced in every array (S, …) by those of ``again`` (k, …),
    SI or dimensionless.
    """
    if isinstance(result, np.ndarray):
        result = result.copy()
        result[at] = again
        return result
    names = [f.name for f in fields(result)]
    return type(result)(**{n: with_sessions_replaced(getattr(result, n), at, getattr(again, n)) for n in names})
