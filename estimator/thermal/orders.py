"""Orders of the polynomials, sensor by sensor, by the evidence of the readings; and what the choice leaves unsaid.

Of the fit θ, C of highest order, leaving the coefficients D out raises χ² by θ_Dᵀ·C_DD⁻¹·θ_D and gives

    θ' = θ − C_·D·C_DD⁻¹·θ_D,    C' = C − C_·D·C_DD⁻¹·C_D·

so every pair of orders of a sensor is compared without another search. The pair with the least BIC = Δχ² − |D|·ln R is
taken (Schwarz 1978; Raftery 1995 for the weights w ∝ exp(−BIC/2)). A term too weak to be taken is still there by its
weight, so the covariance of the chosen coefficients gets Σ w·(θ' − θ̂)(θ' − θ̂)ᵀ and what larger models know less.
"""

from dataclasses import dataclass
from itertools import product

import numpy as np

from estimator.session import Array
from estimator.thermal.solve import ThermalFit


@dataclass(frozen=True, eq=False)
class Orders:
    """The choice for m sensors; p elements a sensor."""

    order: Array
    """(m, 2) orders of scale factor and bias."""
    free: Array
    """(m, p) bool, elements that remain."""
    spread: Array
    """(m, p, p) covariance that the choice adds."""


@dataclass(frozen=True, eq=False)
class OrderChoice:
    """One pair of orders of one sensor."""

    order: tuple[int, int]
    bic: float
    theta: Array
    """(p,)"""
    covariance: Array
    """(p, p)"""


def orders_of(solved: ThermalFit, order: int, ratio: float) -> Orders:
    """Orders of every sensor up to ``order``; ``ratio`` is χ² per degree of freedom of the noise."""
    m, p = solved.free.shape
    theta, q = solved.state.vector, solved.state.scale.shape[1]
    chosen, free, spread = np.zeros((m, 2), dtype=int), solved.free.copy(), np.zeros((m, p, p))
    for i in range(m):
        block = slice(i * p, (i + 1) * p)
        C = solved.covariance[block, block] * ratio
        highest = order if solved.free[i, 0] else 0
        pairs = product(range(highest, -1, -1), range(order, -1, -1))
        models = [model(theta[i], C, pair, (highest, order), q, len(solved.rows.y)) for pair in pairs]
        best = min(models, key=lambda choice: choice.bic)
        chosen[i], spread[i] = best.order, unsaid(models, best)
        free[i, 1 + best.order[0] : highest + 1] = False
        free[i, q + 1 + best.order[1] : q + order + 1] = False
    return Orders(chosen, free, spread)


def model(theta: Array, C: Array, pair: tuple[int, int], highest: tuple[int, int], q: int, rows: int) -> OrderChoice:
    """The fit theta (p,), C (p, p) of one sensor without what is above a pair of orders; the bias' elements from q."""
    out = np.r_[pair[0] + 1 : highest[0] + 1, q + pair[1] + 1 : q + highest[1] + 1].astype(int)
    gain = C[:, out] @ np.linalg.inv(C[np.ix_(out, out)])
    rise = float(theta[out] @ np.linalg.solve(C[np.ix_(out, out)], theta[out])) if len(out) else 0.0
    return OrderChoice(pair, rise - len(out) * float(np.log(rows)), theta - gain @ theta[out], C - gain @ C[out])


def unsaid(models: list[OrderChoice], best: OrderChoice) -> Array:
    """(p, p) covariance that the choice among the models adds to that of the best one."""
    weights = np.exp(-0.5 * np.array([choice.bic - best.bic for choice in models]))
    total = np.zeros_like(best.covariance)
    for weight, choice in zip(weights / weights.sum(), models, strict=True):
        step = choice.theta - best.theta
        larger = choice.order[0] >= best.order[0] and choice.order[1] >= best.order[1]
        total += weight * (np.outer(step, step) + (choice.covariance - best.covariance if larger else 0.0))
    return total
