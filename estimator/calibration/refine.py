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
Source: analytic alignment paper (14), (15); spec'd noise model of the package page.
"""

from dataclasses import dataclass, replace

import numpy as np

from estimator.forward import input_of, jacobian, projected, slope
from estimator.parameters import PLAUSIBLE, SensorParameters
from estimator.reference import Geometry
from estimator.session import Array

RIDGE = PLAUSIBLE**-2
"""Information of the plausible range: keeps what a session does not observe where it started."""

MAX_ITERATIONS = 20
CONVERGED = 1e-8
"""Squared length of a step, in standard errors, below which the iteration has ended."""


@dataclass(frozen=True, eq=False)
class Fitted:
    """Solution for S sessions of one schedule."""

    parameters: SensorParameters
    """Arrays (S, m)."""
    covariance: Array
    """(S, P, P) total, dimensionless elements."""
    repeatability: Array
    """(S, P, P) without the stand's constant errors."""
    information: Array
    """(S, m, 5, 5) each sensor's own information, stand perfect: what observability is judged on."""
    residual: Array
    """(S, R, m) at the input."""
    variance: Array
    """(S, R, m) of the independent noise at the input."""
    chi2: Array
    """(S,)"""
    constant: Array
    """(S, k) estimated constant stand errors."""
    iterations: int
    converged: bool

    def with_chi2(self, chi2: Array) -> "Fitted":
        """The same solution carrying another fit's χ² (S,)."""
        return replace(self, chi2=chi2)


@dataclass(frozen=True, eq=False)
class Normal:
    """One linearisation: bordered normal matrix of (θ, s) and the weighted right-hand side."""

    matrix: Array
    """(S, P + k, P + k)"""
    rhs: Array
    """(S, P + k)"""
    weighted_square: Array
    """(S,) r'W r with the β errors marginalised."""
    own: Array
    """(S, m, 5, 5) information of each sensor alone."""


def gram_positions(m: int) -> tuple[Array, Array]:
    """Row and column indices, (m, 5, 5) each, of the sensors' own blocks in the normal matrix."""
    base = 5 * np.arange(m)[:, None] + np.arange(5)
    return base[:, :, None], base[:, None, :]


def assemble(design: Array, weight: Array, beta: Array, beta_sigma: float, prior: Array) -> Normal:
    """Normal matrix of all sensors with the row errors marginalised.

    Parameters
    ----------
    design : (S, R, m, 5 + k + 1): the Jacobian, the constant errors' columns, the residual.
    weight : (S, R, m) inverse variance of the independent noise.
    beta : (S, R, m) effect of the row's β error.
    beta_sigma : rad.
    prior : (k,) inverse variance of the constant errors.
    """
    S, R, m, width = design.shape
    P, tail = 5 * m, width - 5
    weighted = design * weight[..., None]
    gram = np.swapaxes(weighted, 1, 2).swapaxes(-1, -2) @ np.swapaxes(design, 1, 2)
    full = np.zeros((S, P + tail, P + tail))
    rows, columns = gram_positions(m)
    full[:, rows, columns] = gram[..., :5, :5]
    full[:, P:, :P] = np.moveaxis(gram[..., 5:, :5], 1, 2).reshape(S, tail, P)
    full[:, P:, P:] = gram[..., 5:, 5:].sum(axis=1)
    if beta_sigma > 0:
        touched = weighted * beta[..., None]
        per_row = np.concatenate([touched[..., :5].reshape(S, R, P), touched[..., 5:].sum(axis=2)], axis=-1)
        total = beta_sigma**-2 + (weight * beta * beta).sum(axis=-1)
        full -= per_row.swapaxes(-1, -2) @ (per_row / total[..., None])
    full[:, :P, P:] = full[:, P:, :P].swapaxes(-1, -2)
    matrix = full[:, :-1, :-1].copy()
    diagonal = np.arange(P + tail - 1)
    matrix[:, diagonal, diagonal] += np.concatenate([np.full(P, RIDGE), prior])
    return Normal(matrix, full[:, -1, :-1], full[:, -1, -1], gram[..., :5, :5])


def linearise(y: Array, p: SensorParameters, geometry: Geometry, weight: Array) -> tuple[Normal, Array]:
    """Normal equations at p and the residual there (S, R, m)."""
    residual = y / p.scale[:, None, :] - input_of(p, geometry.n)
    steep = slope(p, geometry.n)
    constant = [steep * projected(p.axis, d) for d in geometry.constant]
    design = np.concatenate(
        [jacobian(p, geometry.n, geometry.norm), *(c[..., None] for c in (*constant, residual))], axis=-1
    )
    beta = steep * projected(p.axis, geometry.beta)
    prior = geometry.constant_sigma**-2.0
    return assemble(design, weight, beta, geometry.beta_sigma, prior), residual


def input_variance(p: SensorParameters, standard_errors: Array, repeatability: Array) -> Array:
    """(S, R, m) variance of the independent noise at the input: (se/K)² + bias repeatability²."""
    return (standard_errors / p.scale[:, None, :]) ** 2 + repeatability**2


def fit(y: Array, variance: Array, geometry: Geometry, start: SensorParameters) -> Fitted:
    """Maximum-likelihood parameters of S sessions of one schedule.

    Parameters
    ----------
    y : (S, R, m) readings, offset taken off (`forward.measured`).
    variance : (S, R, m) of the independent noise at the input.
    geometry : of the schedule.
    start : (S, m) starting values; the closed form where there is one.
    """
    S, _, m = y.shape
    P, weight, p = 5 * m, 1.0 / variance, start
    converged, iteration = False, 0
    while True:
        normal, residual = linearise(y, p, geometry, weight)
        inverse = np.linalg.inv(normal.matrix)
        step = (inverse @ normal.rhs[..., None])[..., 0]
        length = (step[:, :P] * normal.rhs[:, :P]).sum(axis=-1)
        converged = bool(np.all(np.abs(length) < CONVERGED * max(P, 1)))
        if converged or iteration == MAX_ITERATIONS:
            break
        p = p.stepped(step[:, :P].reshape(S, m, 5), geometry.norm)
        iteration += 1
    prior = geometry.constant_sigma**-2.0
    cross = inverse[:, :P, P:] * np.sqrt(prior)
    total = inverse[:, :P, :P]
    return Fitted(
        parameters=p,
        covariance=total,
        repeatability=total - cross @ cross.swapaxes(-1, -2),
        information=normal.own,
        residual=residual,
        variance=variance,
        chi2=normal.weighted_square - (normal.rhs * step).sum(axis=-1),
        constant=step[:, P:],
        iterations=iteration,
        converged=converged,
    )
