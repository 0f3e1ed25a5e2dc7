"""Readings over temperature: the dimensionless model, and its normal equations with the orientations eliminated.

Theory
------
With y = (u − offset)/(K_nominal·N), N = g for accelerometers and 1 rad/s for gyros,

    y = G·(s + β + γ·s²) + noise,    G = Σ G_k·φ_k(T),    β = Σ β_k·ψ_k(T, t),    s = e·n

n is of length one: the direction of the specific force in one setting of the block, two unknown turns of its own and
where the session states directions a normal prior; for gyros the Earth's rate of that setting, three unknowns of
variance Ω²/3 each, since nobody knows the heading. Rows between which the block is not touched share a setting. Of
gyros at rest β alone is free. The settings are eliminated as in `estimator.calibration.free.model` (Schur complement).

Where no directions are stated, a common turn of all axes and settings changes nothing. It is held by the nominal axes:
Σ e_nominal × δe = 0, as equations of large weight, which the readings cannot oppose.

R rows, m sensors, G settings; p = q + b + 3 elements a sensor: G_0…, β_0…, γ and two turns of the axis.
"""

from dataclasses import dataclass, replace

import numpy as np

from estimator.applied_vector import EARTH_RATE
from estimator.arrays import crossed, nearest_turn, tangents, unit
from estimator.session import Array

HOLDING = 1e4
"""Weight of the gauge's equations relative to the largest information: its turn is then known a hundred times better
than the best known element, and rounding leaves eight digits."""
TURNS = 2
"""Unknowns of a setting that turn its direction; three more are the Earth's rate."""


@dataclass(frozen=True, eq=False)
class ThermalRows:
    """The measurements, dimensionless (rad/s for gyros)."""

    y: Array
    """(R, m)"""
    sigma: Array
    """(R, m) one sigma of y."""
    setting: Array
    """(R,) number of the setting that a row was measured in."""
    directions: Array
    """(G, 3) stated directions, unit vectors; zeros where not stated."""
    prior: Array
    """(G,) their inverse variance, rad⁻²; 0 where not stated."""
    nominal_axes: Array
    """(m, 3) unit vectors."""
    gyro: Array
    """(m,) bool."""
    scale_basis: Array
    """(R, q) φ"""
    bias_basis: Array
    """(R, b) ψ"""

    @property
    def elements(self) -> int:
        """p, of one sensor."""
        return self.scale_basis.shape[1] + self.bias_basis.shape[1] + 3


@dataclass(frozen=True, eq=False)
class State:
    """The unknowns at one point of the search."""

    scale: Array
    """(m, q) G_k"""
    bias: Array
    """(m, b) β_k"""
    quadratic: Array
    """(m,) γ"""
    axes: Array
    """(m, 3) unit vectors."""
    directions: Array
    """(G, 3) unit vectors."""
    rates: Array
    """(G, 3) the Earth's rate, rad/s."""

    @property
    def vector(self) -> Array:
        """(m, p) vector of all elements but the turns, which are counted from here."""
        return np.column_stack([self.scale, self.bias, self.quadratic, np.zeros((len(self.axes), 2))])

    def stepped(self, step: Array, settings: Array) -> "State":
        """Moved by a step (m, p) of the elements and (G, 5) of the settings."""
        q, b = self.scale.shape[1], self.bias.shape[1]
        turned = self.axes + (tangents(self.axes) @ step[:, q + b + 1 :, None])[..., 0]
        tipped = self.directions + (tangents(self.directions) @ settings[:, :TURNS, None])[..., 0]
        return State(
            scale=self.scale + step[:, :q],
            bias=self.bias + step[:, q : q + b],
            quadratic=self.quadratic + step[:, q + b],
            axes=unit(turned),
            directions=unit(tipped),
            rates=self.rates + settings[:, TURNS:],
        )

    def held(self, rows: ThermalRows) -> "State":
        """The state with the accelerometers' frame turned so that it shows no net turn against the nominal axes."""
        live = ~rows.gyro
        if rows.prior.any() or not live.any():
            return self
        turn = nearest_turn(self.axes[live], rows.nominal_axes[live])
        axes = np.where(live[:, None], self.axes @ turn.T, self.axes)
        return replace(self, axes=axes, directions=self.directions @ turn.T)


@dataclass(frozen=True, eq=False)
class ThermalEquations:
    """One linearisation, in sigmas of the readings. P = m·p."""

    residual: Array
    """(R, m)"""
    local: Array
    """(R, m, p) derivative by the sensor's own elements."""
    shared: Array
    """(R, m, 5) derivative by the setting's elements."""
    inverse: Array
    """(G, 5, 5) inverse of the settings' own information."""
    coupling: Array
    """(G, P, 5)"""
    setting_gradient: Array
    """(G, 5)"""
    score: Array
    """(P,) U, the settings eliminated."""
    information: Array
    """(P, P) F, the settings eliminated, the gauge held."""

    def settings(self, step: Array) -> Array:
        """(G, 5) the settings' best step for a step (P,) of the elements."""
        return np.einsum("gab,gb->ga", self.inverse, self.setting_gradient - step @ self.coupling)


def inputs(rows: ThermalRows, state: State) -> tuple[Array, Array, Array]:
    """s and gain G and s + β + γ·s², (R, m) each, dimensionless (of gyros s and the last rad/s)."""
    vectors = np.where(rows.gyro[:, None], state.rates[rows.setting][:, None], state.directions[rows.setting][:, None])
    s = (vectors * state.axes).sum(axis=-1)
    return s, rows.scale_basis @ state.scale.T, s + rows.bias_basis @ state.bias.T + state.quadratic * s * s


def residuals(rows: ThermalRows, state: State) -> Array:
    """(R, m) measured less modelled y."""
    _, gain, whole = inputs(rows, state)
    return rows.y - gain * whole


def cost(rows: ThermalRows, state: State) -> float:
    """χ² of the readings, of stated directions and, with gyros, of the Earth's rate."""
    turned = rows.prior[:, None] * (rows.directions - state.directions) ** 2
    rates = (state.rates / EARTH_RATE) ** 2 * 3
    return float(((residuals(rows, state) / rows.sigma) ** 2).sum() + turned.sum() + rates.sum())


def jacobian(rows: ThermalRows, state: State) -> tuple[Array, Array]:
    """Derivatives of y: (R, m, p) by each sensor's elements, (R, m, 5) by its setting's."""
    s, gain, whole = inputs(rows, state)
    slope = gain * (1 + 2 * state.quadratic * s)
    d, across = state.directions[rows.setting], tangents(state.directions)[rows.setting]
    turns = np.einsum("ra,mab->rmb", d, tangents(state.axes))
    local = np.concatenate(
        [
            whole[..., None] * rows.scale_basis[:, None],
            gain[..., None] * rows.bias_basis[:, None],
            (gain * s * s)[..., None],
            slope[..., None] * turns,
        ],
        axis=-1,
    )
    local[:, rows.gyro, : rows.scale_basis.shape[1]] = 0.0
    local[:, rows.gyro, -3:] = 0.0
    tips = np.einsum("ma,rab->rmb", state.axes, across) * (slope * ~rows.gyro)[..., None]
    return local, np.concatenate([tips, slope[..., None] * state.axes * rows.gyro[:, None]], axis=-1)


def linearise(rows: ThermalRows, state: State) -> ThermalEquations:
    """Normal equations at one point; shapes and units: see `ThermalEquations`."""
    R, m, p = *rows.y.shape, rows.elements
    groups = len(rows.prior)
    local, shared = (part / rows.sigma[..., None] for part in jacobian(rows, state))
    residual = residuals(rows, state) / rows.sigma
    setting_information = np.zeros((groups, 5, 5))
    np.add.at(setting_information, rows.setting, np.swapaxes(shared, 1, 2) @ shared)
    stated = np.concatenate(
        [np.repeat(rows.prior[:, None], 2, axis=1), np.full((groups, 3), 3 / EARTH_RATE**2)], axis=1
    )
    setting_information[:, range(5), range(5)] += np.maximum(stated, np.finfo(float).tiny ** 0.5)
    inverse = np.linalg.inv(setting_information)
    pull = np.concatenate(
        [
            np.einsum(
                "ga,gab->gb", rows.prior[:, None] * (rows.directions - state.directions), tangents(state.directions)
            ),
            -state.rates * 3 / EARTH_RATE**2,
        ],
        axis=1,
    )
    np.add.at(pull, rows.setting, np.einsum("rm,rmc->rc", residual, shared))
    coupling = np.zeros((groups, m * p, 5))
    np.add.at(coupling, rows.setting, (local[..., None] * shared[:, :, None]).reshape(R, m * p, 5))
    information = np.zeros((m, p, m, p))
    information[range(m), :, range(m)] = np.einsum("rmi,rmj->mij", local, local)
    flat = coupling @ inverse
    across = np.swapaxes(coupling, 1, 2).reshape(-1, m * p)
    F = information.reshape(m * p, m * p) - np.swapaxes(flat, 1, 2).reshape(-1, m * p).T @ across
    U = np.einsum("rm,rmi->mi", residual, local).ravel() - np.einsum("gpc,gc->p", flat, pull)
    return ThermalEquations(residual, local, shared, inverse, coupling, pull, U, (F + F.T) / 2 + gauge(rows, state, F))


def gauge(rows: ThermalRows, state: State, F: Array) -> Array:
    """(P, P) information that holds the frame; nothing where stated directions do."""
    live = np.flatnonzero(~rows.gyro)
    if rows.prior.any() or not len(live):
        return np.zeros_like(F)
    held = np.zeros((3, len(rows.gyro), rows.elements))
    turns = crossed(rows.nominal_axes[live]) @ tangents(state.axes[live])
    held[:, live, -2:] = np.swapaxes(turns, 0, 1)
    flat = held.reshape(3, -1)
    largest = np.diagonal(F).reshape(held.shape[1:])[live].max()
    return np.asarray(HOLDING * largest * flat.T @ flat)
