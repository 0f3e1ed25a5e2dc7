"""Levenberg–Marquardt on the parameters with the orientations eliminated, under given noise.

The damping acts on the parameters alone: given them, the orientations are well determined by every row.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial

import numpy as np

from estimator.arrays import eigh, nearest_turn
from estimator.calibration.free.information import Information, information, movable, unseen_below
from estimator.calibration.free.model import Linear, ModelRows, Unknowns, cost, linearise
from estimator.calibration.free.schedule import Mask
from estimator.session import Array

MAX_ITERATIONS = 200
"""Most iterations of one search; three are usual, and one that has not ended by then has `converged` False."""

CONVERGED = 1e-10
"""Expected fall of χ² below which the search has ended: steps of 1e-5 standard errors."""

STILL = 1e-13
"""Dimensionless steps below this are rounding."""

LEAST_DAMPING = 1e-12
"""Relative to the largest information: less is rounding, and damping must be able to grow back in a few steps."""

FIRST_DAMPING = 1e-4
"""Damping at the start, relative to the largest information. The start is good to a few per cent: nearly a Gauss–Newton
step.
"""

LONGEST = 0.5
"""Dimensionless; no element moves further in one step; a turn along a tangent means little beyond."""

NO_FREEDOM = 0.5
"""Degrees of freedom at or below which the readings tell nothing of their noise. Unlabelled orientations leave whole
numbers; half of one is left where loosely labelled ones spend it on the labels."""


Modes = tuple[Array, Array, Array, Array]
"""Basis (5 m, F) of what may move, eigenvalues (F,), rising, and eigenvectors (F, F) of the information within it, and
the right-hand side along these (F,)."""


@dataclass(frozen=True, eq=False)
class Solution:
    """The end of a search."""

    rows: ModelRows
    """The rows, with the noise that was used."""
    unknowns: Unknowns
    quadratic: bool
    """Whether the quadratic term was estimated."""
    chi2: float
    learned: Callable[[], Information]
    """`knowledge`, worked out when it is first asked for: of most searches only χ² is."""
    iterations: int
    converged: bool
    freedom: float = np.inf
    """Degrees of freedom that the noise is known to; infinite where it was stated and explains the residuals."""
    borrows: Mask | None = None
    """(m,) where each sensor's noise was estimated: whether it is taken as like the others'."""

    @property
    def knowledge(self) -> Information:
        """Information of the readings on the parameters."""
        return self.learned()

    @property
    def knows_noise(self) -> bool:
        """Whether the noise is known, so that uncertainties can be given."""
        return self.freedom > NO_FREEDOM

    @property
    def dof(self) -> int:
        """Readings and stated directions, less what was estimated: parameters seen and two turns an orientation."""
        return self.rows.spare - self.knowledge.rank


def held_frame(rows: ModelRows, unknowns: Unknowns) -> Unknowns:
    """The unknowns with the frame turned so that the axes show no net turn against the nominal ones."""
    if rows.held:
        return unknowns
    return unknowns.turned(nearest_turn(unknowns.axes, rows.nominal_axes))


def search(rows: ModelRows, unknowns: Unknowns, quadratic: bool) -> Solution:
    """Least χ² from a start. Not reaching it is a result (`converged` False)."""
    unknowns = held_frame(rows, unknowns)
    damping, chi2 = FIRST_DAMPING, cost(rows, unknowns)
    linear, iterations, converged = linearise(rows, unknowns), 0, False
    modes: Modes | None = None
    while not converged and iterations < MAX_ITERATIONS:
        iterations += 1
        modes = modes or modes_of(linear, movable(rows, unknowns, quadratic))
        step, turns, fall = proposal(linear, modes, damping)
        trial = held_frame(rows, unknowns.stepped(step, turns))
        trial_cost = cost(rows, trial)
        small = max(np.abs(step).max(), np.abs(turns).max()) < STILL
        converged = bool(small or fall < CONVERGED * max(1.0, chi2 * CONVERGED))
        if trial_cost < chi2:
            unknowns, chi2, damping = trial, trial_cost, max(damping / 10, LEAST_DAMPING)
            linear, modes = linearise(rows, unknowns), None
        else:
            damping *= 10
    learned = cache(partial(information, rows, unknowns, quadratic, linear))
    return Solution(rows, unknowns, quadratic, chi2, learned, iterations, converged)


def modes_of(linear: Linear, basis: Array) -> Modes:
    """``basis`` (5 m, F), dimensionless as in `movable`, and what ``linear`` tells within it."""
    values, vectors = eigh(basis.T @ linear.schur @ basis)
    return basis, values, vectors, vectors.T @ (basis.T @ linear.reduced)


def proposal(linear: Linear, modes: Modes, damping: float) -> tuple[Array, Array, float]:
    """Damped step of the parameters (5 m,), turns of the orientations (R, 2), rad, and the fall of χ² they promise.

    Directions that the set does not determine stay where they are.
    """
    basis, values, vectors, right = modes
    inside = np.where(values > unseen_below(values), right, 0.0) / (
        np.maximum(values, 0.0) + damping * linear.full.max()
    )
    inside = inside * min(1.0, LONGEST / max(float(np.abs(inside).max()), LONGEST))
    step = basis @ (vectors @ inside)
    turns = linear.turns(step)
    turns = turns * min(1.0, LONGEST / max(float(np.abs(turns).max()), LONGEST))
    return step, turns, float(right @ inside + (linear.turn_gradient * linear.alone).sum())
