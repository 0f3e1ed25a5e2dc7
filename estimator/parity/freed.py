"""The change of the sensors, freed of what motion does to sound ones.

The unknowns u of `nuisance`, prior N(0, I), are fitted together with Θ: with p = z·Θ + Φ·u + noise, and what z leaves
of p and Φ after its fit,

    û = S·Φᵀp/σ²,   S = (I + ΦᵀΦ/σ²)⁻¹,   Θ̂ = Θ of (p − Φû),   error of Θ̂ = noise's + J·(û − u),  J = −(zᵀz)⁻¹zᵀΦ

The two parts of the error are uncorrelated for white noise, and J·S·Jᵀ is the second's covariance. Where nothing moves
Φ vanishes, and so does all of this. σ² is what the noise of Θ̂, whatever its colour, is for one block.
"""

from dataclasses import replace

import numpy as np

from estimator.parity.blocks import BlockSelection
from estimator.parity.nuisance import ParityNuisance
from estimator.parity.reference import ParityReference
from estimator.parity.regression import ParityChange, regress
from estimator.session import Array

ROUNDS = 3
"""Times that σ² is taken anew from what is left: after the third it changes by less than it is known."""


def freed(
    selection: BlockSelection, reference: ParityReference, norm: float | None, nuisance: ParityNuisance
) -> ParityChange:
    """Θ and its covariance with the unknowns fitted beside it; arguments as of `regression.regress`."""
    mean = selection.blocks.mean - nuisance.known
    u = np.zeros(len(nuisance.sensor))
    change = regress(_with(selection, mean), reference, norm)
    for _ in range(ROUNDS):
        u, covariance, spent = _fitted(selection, mean, reference, nuisance, change)
        change = regress(_with(selection, mean - nuisance.moved(u)), reference, norm, spent=spent)
    return replace(change, motion=covariance)


def _with(selection: BlockSelection, mean: Array) -> BlockSelection:
    """The selection with other means (B, m) of the inputs, m/s² (rad/s)."""
    return replace(selection, blocks=replace(selection.blocks, mean=mean))


def _fitted(
    selection: BlockSelection, mean: Array, reference: ParityReference, nuisance: ParityNuisance, change: ParityChange
) -> tuple[Array, Array, float]:
    """û (k,), the covariance (q, q) that it leaves in Θ, (m/s²)² ((rad/s)²), and how many unknowns the data fitted."""
    V, c, who = reference.parity, nuisance.coefficient, nuisance.sensor
    n = reference.vector(mean)
    w = selection.blocks.samples / selection.blocks.samples.mean()
    z = np.column_stack([np.ones(len(n)), n / change.norm]) @ change.excited
    zw = w[:, None] * z
    G = zw.T @ z
    pull = np.linalg.solve(G, zw.T @ nuisance.signals)
    remainder = nuisance.signals - z @ pull
    p = mean @ V
    residual = p - z @ np.linalg.solve(G, zw.T @ p)
    variance = _variance(change, G)
    alike = V[who] @ V[who].T
    information = (c @ (remainder.T @ (w[:, None] * remainder)) @ c.T) * alike / variance
    right = np.einsum("kK,Kd,kd->k", c, remainder.T @ (w[:, None] * residual), V[who]) / variance
    S = np.linalg.inv(np.eye(len(who)) + information)
    J = np.einsum("sK,kK,kd->sdk", pull, c, V[who]).reshape(-1, len(who))
    return S @ right, J @ S @ J.T, float(len(who) - np.trace(S))


def _variance(change: ParityChange, G: Array) -> float:
    """σ² of an element of p in a block of weight one, (m/s²)² ((rad/s)²), as the noise of Θ has it."""
    s, d = change.theta.shape
    noise = change.noise.reshape(s, d, s, d)
    variance = float(np.einsum("sdtd,st->", noise, G)) / (s * d)
    return max(variance, np.finfo(float).tiny)
