"""Levenberg–Marquardt on the parameters with the orientations eliminated, and the noise where none is stated.

The damping acts on the parameters alone: given them, the orientations are well determined by every row. Unstated noise
is one variance a sensor, estimated from the residuals and the redundancy that each sensor's readings have left
(Förstner's variance components); with little redundancy the sensors share one variance.
"""

from dataclasses import dataclass, replace

import numpy as np

from estimator.arrays import nearest_turn
from estimator.calibration.free.information import Information, information, movable, unseen_below
from estimator.calibration.free.model import Linear, Rows, Unknowns, cost, linearise
from estimator.session import Array

MAX_ITERATIONS = 200
"""Of one search; three are usual, and one that has not ended by then says so."""
MOST_ITERATIONS = 600
"""Of all searches while the noise settles."""

CONVERGED = 1e-10
"""Expected fall of χ² below which the search has ended: steps of 1e-5 standard errors."""

STILL = 1e-13
"""Dimensionless steps below this are rounding."""

LEAST_DAMPING = 1e-12
"""Relative to the largest information: less is rounding, and damping must be able to grow back in a few steps."""

FIRST_DAMPING = 1e-4
"""The same, at the start, which is good to a few per cent: nearly a Gauss–Newton step."""

LONGEST = 0.5
"""Dimensionless; no element moves further in one step; a turn along a tangent means little beyond."""

NOISE_ROUNDS = 25
"""Rounds of search and noise; the last is taken where they do not settle."""
NOISE_SETTLED = 1e-4
"""Relative change of the noise between rounds below which it has settled."""

ENOUGH_REDUNDANCY = 10.0
"""Redundancy that a sensor's readings need to have a noise variance of their own: it tells a sigma to a quarter."""

LEAST_NOISE = 1e-12
"""Dimensionless; readings are not better than rounding."""


@dataclass(frozen=True, eq=False)
class Solution:
    """Where the search ended."""

    rows: Rows
    """With the noise that was used."""
    unknowns: Unknowns
    quadratic: bool
    """Whether the quadratic term was estimated."""
    chi2: float
    knowledge: Information
    iterations: int
    converged: bool

    @property
    def dof(self) -> int:
        """Readings and stated directions, less what was estimated: parameters seen and two turns an orientation."""
        stated = 2 * int(np.count_nonzero(self.rows.prior))
        R, m = self.rows.y.shape
        return R * m + stated - 2 * R - self.knowledge.rank


def held_frame(rows: Rows, unknowns: Unknowns) -> Unknowns:
    """The unknowns with the frame turned so that the axes show no net turn against the nominal ones."""
    if rows.held:
        return unknowns
    return unknowns.turned(nearest_turn(unknowns.axes, rows.nominal_axes))


def search(rows: Rows, unknowns: Unknowns, quadratic: bool) -> Solution:
    """Least χ² from a start. Not reaching it is a result (`converged` False)."""
    unknowns = held_frame(rows, unknowns)
    damping, chi2 = FIRST_DAMPING, cost(rows, unknowns)
    linear, iterations, converged = linearise(rows, unknowns), 0, False
    basis = movable(rows.nominal_axes, unknowns.axes, rows.held, quadratic)
    while not converged and iterations < MAX_ITERATIONS:
        iterations += 1
        step, turns, fall = proposal(linear, basis, damping)
        trial = held_frame(rows, unknowns.stepped(step, turns))
        found = cost(rows, trial)
        small = max(np.abs(step).max(), np.abs(turns).max()) < STILL
        converged = bool(small or fall < CONVERGED * max(1.0, chi2 * CONVERGED))
        if found < chi2:
            unknowns, chi2, damping = trial, found, max(damping / 10, LEAST_DAMPING)
            linear = linearise(rows, unknowns)
            basis = movable(rows.nominal_axes, unknowns.axes, rows.held, quadratic)
        else:
            damping *= 10
    knowledge = information(rows, unknowns, quadratic, linear)
    return Solution(rows, unknowns, quadratic, chi2, knowledge, iterations, converged)


def proposal(linear: Linear, basis: Array, damping: float) -> tuple[Array, Array, float]:
    """Damped step of the parameters (5 m,), turns of the orientations (R, 2), rad, and the fall of χ² they promise.

    ``basis`` (5 m, F), dimensionless as in `movable`. Directions that the set does not determine stay where they are.
    """
    values, vectors = np.linalg.eigh(basis.T @ linear.schur @ basis)
    right = vectors.T @ (basis.T @ linear.reduced)
    inside = np.where(values > unseen_below(values), right, 0.0) / (
        np.maximum(values, 0.0) + damping * linear.full.max()
    )
    inside = inside * min(1.0, LONGEST / max(float(np.abs(inside).max()), LONGEST))
    step = basis @ (vectors @ inside)
    turns = linear.turns(step)
    turns = turns * min(1.0, LONGEST / max(float(np.abs(turns).max()), LONGEST))
    direct = np.einsum("ra,rab,rb->", linear.turn_gradient, linear.inverse, linear.turn_gradient)
    return step, turns, float(right @ inside + direct)


def redundancy(rows: Rows, unknowns: Unknowns, knowledge: Information) -> Array:
    """(R, m) part of each reading's variance that the fit leaves in its residual: 1 − leverage, dimensionless."""
    linear = linearise(rows, unknowns)
    m = rows.y.shape[1]
    through = (linear.shared[:, :, None, :] @ linear.inverse[:, None])[:, :, 0, :]
    direct = (through * linear.shared).sum(axis=-1)
    root = knowledge.seen * np.sqrt(knowledge.variances)
    moved = np.einsum("rma,rpa->rmp", through, linear.coupling) @ root
    own = np.einsum("rmi,mif->rmf", linear.own, root.reshape(m, 5, -1))
    return np.clip(1.0 - direct - ((own - moved) ** 2).sum(axis=-1), 0.0, 1.0)


def noise_variance(solution: Solution) -> Array:
    """(m,) factors, dimensionless, by which the variances used must be multiplied to agree with the residuals."""
    rows = solution.rows
    left = redundancy(rows, solution.unknowns, solution.knowledge).sum(axis=0)
    squares = (linearise(rows, solution.unknowns).residual ** 2).sum(axis=0)
    common = squares.sum() / max(left.sum(), 1.0)
    if left.min() < ENOUGH_REDUNDANCY:
        return np.full(len(left), common)
    return squares / left


def search_with_noise(rows: Rows, unknowns: Unknowns, quadratic: bool) -> Solution:
    """The search with the noise estimated on the way; ``rows.sigma`` gives the relative weights to begin with."""
    solution = search(rows, unknowns, quadratic)
    iterations = solution.iterations
    for _ in range(NOISE_ROUNDS):
        factor = np.sqrt(noise_variance(solution))
        sigma = np.maximum(solution.rows.sigma * factor, LEAST_NOISE)
        change = np.abs(sigma / solution.rows.sigma - 1.0).max()
        solution = search(rows.weighted(sigma), solution.unknowns, quadratic)
        iterations += solution.iterations
        if change < NOISE_SETTLED or iterations > MOST_ITERATIONS:
            break
    return replace(solution, iterations=iterations)
