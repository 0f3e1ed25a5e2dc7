"""Readings in unknown orientations: the dimensionless model, its Jacobian, and the orientations eliminated.

Theory
------
With readings y = (u − offset)/(K_nominal·g), orientation d_j a unit vector and s = e_i·d_j,

    y_ij = exp(λ_i)·(s + γ_i·s²) + o_i + noise        λ = ln(K/K_nominal), γ = c·g, o = exp(λ)·b/g

The offset o stands in for the bias while solving, so that an offset of half a converter's range stays linear. Each
d_j has two degrees of freedom of its own (and, where the session states directions, a normal prior about the stated
one). They touch one orientation only, so the normal matrix of all unknowns is

    [ N   B ]      N (5m, 5m) block diagonal, one block a sensor
    [ Bᵀ  D ]      D one 2×2 block an orientation

and the Schur complement S = N − B D⁻¹ Bᵀ is the information that the sensors' parameters are left with: the same as
variable projection of the orientations. R orientations, m sensors.
Source: multi-parameter optimisation paper, functional (5), in its maximum-likelihood form.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from estimator.arrays import tangents, unit
from estimator.session import Array

LEAST_TURN = 1e-13
"""Part of an orientation's information that is added to it, so that sensors that agree on one plane leave no hole: some
hundred roundings, far below what any reading resolves."""


WEIGHTLESS = 100.0
"""One sigma, in g, from which a reading takes no part: no accelerometer is as bad."""


@dataclass(frozen=True, eq=False)
class ModelRows:
    """The measurements, dimensionless. R orientations, m accelerometers."""

    y: Array
    """(R, m) readings over nominal scale times g, nominal offset taken off."""
    sigma: Array
    """(R, m) one sigma of y, dimensionless; infinite, or beyond `WEIGHTLESS`, of readings that take no part."""
    directions: Array
    """(R, 3) stated directions, unit vectors; zeros where not stated."""
    prior: Array
    """(R,) inverse variance of the stated directions, rad⁻²; 0 where not stated."""
    nominal_axes: Array
    """(m, 3)"""

    @property
    def held(self) -> bool:
        """Whether stated directions hold the block's frame."""
        return bool(np.any(self.prior > 0))

    @property
    def takes_part(self) -> Array:
        """(R, m) bool"""
        return self.sigma < WEIGHTLESS

    @property
    def spare(self) -> int:
        """Readings and stated directions beyond the two turns of every orientation."""
        told = self.takes_part.sum(axis=1) + 2 * (self.prior > 0)
        return int(np.maximum(told - 2, 0).sum())

    def weighted(self, sigma: Array) -> "ModelRows":
        """The measurements with another noise, dimensionless: (R, m) or anything that broadcasts to it."""
        return replace(self, sigma=np.broadcast_to(sigma, self.y.shape))


@dataclass(frozen=True, eq=False)
class Unknowns:
    """The unknowns at one point of the search: parameters of m sensors and R orientations; dimensionless."""

    log_scale: Array
    """(m,) λ"""
    offset: Array
    """(m,) o"""
    quadratic: Array
    """(m,) γ"""
    axes: Array
    """(m, 3) unit vectors, block axes."""
    directions: Array
    """(R, 3) directions of the specific force, unit vectors, block axes."""

    @cached_property
    def axis_tangents(self) -> Array:
        """(m, 3, 2) along which the axes turn, dimensionless."""
        return tangents(self.axes)

    @cached_property
    def direction_tangents(self) -> Array:
        """(R, 3, 2) along which the orientations turn, dimensionless."""
        return tangents(self.directions)

    def stepped(self, parameters: Array, turns: Array) -> "Unknowns":
        """Moved by parameters (5 m,), dimensionless, and turns (R, 2) of the orientations, rad."""
        step = parameters.reshape(-1, 5)
        return Unknowns(
            log_scale=self.log_scale + step[:, 0],
            offset=self.offset + step[:, 1],
            quadratic=self.quadratic + step[:, 2],
            axes=unit(self.axes + (self.axis_tangents @ step[:, 3:, None])[..., 0]),
            directions=unit(self.directions + (self.direction_tangents @ turns[..., None])[..., 0]),
        )

    def turned(self, rotation: Array) -> "Unknowns":
        """The block's frame turned by a rotation (3, 3), dimensionless: every axis and every orientation."""
        return replace(self, axes=self.axes @ rotation.T, directions=self.directions @ rotation.T)


def predicted(unknowns: Unknowns) -> Array:
    """(R, m) readings predicted by the model, relative to nominal scale times g."""
    s = unknowns.directions @ unknowns.axes.T
    return np.exp(unknowns.log_scale) * (s + unknowns.quadratic * s * s) + unknowns.offset


def cost(rows: ModelRows, unknowns: Unknowns) -> float:
    """χ²: squared residuals of the readings and of the stated directions, in their sigmas."""
    readings = np.sum(((rows.y - predicted(unknowns)) / rows.sigma) ** 2)
    return float(readings + np.sum(rows.prior[:, None] * (rows.directions - unknowns.directions) ** 2))


@dataclass(frozen=True, eq=False)
class Linear:
    """One linearisation, in units of the readings' sigmas."""

    residual: Array
    """(R, m) residuals in sigmas."""
    local: Array
    """(R, m, 5) derivative of each reading by its own sensor's parameters."""
    shared: Array
    """(R, m, 2) derivative by the orientation's two turns."""
    inverse: Array
    """(R, 2, 2) D⁻¹"""
    coupling: Array
    """(R, 5 m, 2) B"""
    gradient: Array
    """(5 m,) right-hand side of the parameters alone."""
    turn_gradient: Array
    """(R, 2) right-hand side of the orientations."""
    full: Array
    """(5 m,) diagonal of N."""
    schur: Array
    """(5 m, 5 m) S"""

    @cached_property
    def alone(self) -> Array:
        """(R, 2) turns of the orientations, rad, were the parameters to stay."""
        return np.asarray((self.inverse @ self.turn_gradient[..., None])[..., 0])

    @property
    def reduced(self) -> Array:
        """(5 m,) right-hand side with the orientations eliminated."""
        return self.gradient - (self.coupling @ self.alone[..., None]).sum(axis=0)[:, 0]

    def turns(self, step: Array) -> Array:
        """(R, 2) the orientations' best turns for a step (5 m,) of the parameters."""
        return self.alone - (self.inverse @ (step @ self.coupling)[..., None])[..., 0]


def jacobian(unknowns: Unknowns) -> tuple[Array, Array]:
    """Derivatives of `predicted`, relative: (R, m, 5) by each sensor's parameters, (R, m, 2) per rad of its turns."""
    s = unknowns.directions @ unknowns.axes.T
    gain = np.exp(unknowns.log_scale)
    slope = gain * (1.0 + 2.0 * unknowns.quadratic * s)
    local = np.empty((*s.shape, 5))
    local[..., 0] = gain * (s + unknowns.quadratic * s * s)
    local[..., 1] = 1.0
    local[..., 2] = gain * s * s
    local[..., 3:] = slope[..., None] * (unknowns.directions @ unknowns.axis_tangents).swapaxes(0, 1)
    shared = slope[..., None] * (unknowns.axes @ unknowns.direction_tangents)
    return local, shared


def linearise(rows: ModelRows, unknowns: Unknowns) -> Linear:
    """Jacobian, normal equations and Schur complement at one point; shapes and units: see `Linear`."""
    R, m = rows.y.shape
    local, shared = jacobian(unknowns)
    local, shared = local / rows.sigma[..., None], shared / rows.sigma[..., None]
    residual = (rows.y - predicted(unknowns)) / rows.sigma
    D = np.swapaxes(shared, 1, 2) @ shared + rows.prior[:, None, None] * np.eye(2)
    D += (LEAST_TURN * np.trace(D, axis1=1, axis2=2) + np.finfo(float).tiny ** 0.5)[:, None, None] * np.eye(2)
    inverse = np.linalg.inv(D)
    turn_gradient = (residual[:, None] @ shared)[:, 0]
    if rows.held:
        off = rows.prior[:, None, None] * (rows.directions - unknowns.directions)[:, None]
        turn_gradient = turn_gradient + (off @ unknowns.direction_tangents)[:, 0]
    coupling = (local[..., :, None] * shared[..., None, :]).reshape(R, 5 * m, 2)
    by_sensor = local.swapaxes(0, 1)
    blocks = np.swapaxes(by_sensor, 1, 2) @ by_sensor
    spread = np.zeros((m, 5, m, 5))
    spread[np.arange(m), :, np.arange(m), :] = blocks
    N = spread.reshape(5 * m, 5 * m)
    flat = np.swapaxes(coupling @ inverse, 1, 2).reshape(2 * R, 5 * m)
    schur = N - np.swapaxes(coupling, 1, 2).reshape(2 * R, 5 * m).T @ flat
    return Linear(
        residual=residual,
        local=local,
        shared=shared,
        inverse=inverse,
        coupling=coupling,
        gradient=(residual.T[:, None] @ by_sensor).ravel(),
        turn_gradient=turn_gradient,
        full=np.diagonal(N).copy(),
        schur=(schur + schur.T) / 2,
    )
