"""Readings that switch between levels from row to row: scatter that is large, white, and still no noise.

Theory
------
A residual y (n,), white under noise and freed of what the calibration absorbs, is weighed as y = k·L's + noise: the
state s of every one of R rows is −1, 0 or 1, k the size and L (R, n) what the calibration leaves of a reading. So reads
what depends on the way by which a position was reached, a loose contact, or burst noise (a random telegraph signal;
Machlup 1954, J. Appl. Phys. 25, 341). Against normal noise of unknown variance the Bayes factor of one sequence of
states, its size at the best and charged for (Schwarz 1978, Ann. Statist. 6, 461), is

    ln B = ½ n ln(E/E_s) − ½ ln n + Σ ln p(s_r),      E = |y|²,  E_s = E − (y'L's)²/|L's|²

with E_s no less than the noise that is known to be there. The likeliest sequence is found by changing one state at a
time while that raises B. It weighs less than all sequences together, whose mean has expectation one under noise, so
that noise reaches B in no more than a share 1/B of all sensors (Markov).
"""

import numpy as np

from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.diagnosis.signatures.autocorrelation import FEWEST, sensor_residual
from estimator.session import Array

STATES = np.array([-1.0, 0.0, 1.0])
USUAL = np.log([0.45, 0.1, 0.45])
"""ln of the states' prior share: a row between both, such as the first one of a run, is the exception."""

FAINTEST = 1e-9
"""Share of a sequence's length, or of the energy, below which the calibration leaves nothing of it: rounding."""


PUT_BACK = (-2.0, -1.0, -0.5, 0.5, 1.0, 2.0)
"""Times the residual's length that a direction which the calibration absorbs is put back before the search: a sequence
that looks much like one of them shows a small part of itself, whose signs are not its own."""


def switching(residuals: WhitenedResiduals, attributed: Array, sensor: int, least: float = 0.0) -> float:
    """ln B of readings that switch between levels against normal noise; −∞ where the residual is too short to tell.

    ``attributed`` (n, f) orthonormal traces of the findings, dimensionless; ``least``: part of the variance that the
    residuals are whitened by that is known to be noise.
    """
    root, y = sensor_residual(residuals, attributed, sensor)
    if len(y) < FEWEST:
        return -np.inf
    return likeliest_states(root, y, residuals.baseline.design[:, sensor], least)[0]


def likeliest_states(root: Array, y: Array, absorbed: Array, least: float = 0.0) -> tuple[float, Array]:
    """ln B and states (R,), dimensionless, of rows that ``root`` (R, n) leads to residuals ``y`` (n,), standard errors.

    The search starts from what is left, and from that with a direction that the calibration absorbs put back;
    ``absorbed`` (R, p), of any unit.
    """
    remaining = unit(root @ y)
    starts = [remaining, *(remaining + share * unit(column) for column in absorbed.T for share in PUT_BACK)]
    value, states = climbed(root, y, np.unique(np.where(np.array(starts) < 0, 0, 2), axis=0), least)
    best = int(np.argmax(value))
    return float(value[best]), states[best]


def unit(column: Array) -> Array:
    """(R,) dimensionless: a column at unit length."""
    return np.asarray(column / max(float(np.linalg.norm(column)), 1e-300))


def climbed(root: Array, y: Array, state: Array, least: float) -> tuple[Array, Array]:
    """ln B (K,) and states (K, R) from K starts numbered ``state`` (K, R) int: of each one state is changed at a time
    while that raises its B."""
    gram, along = root @ root.T, root @ y
    state, best, moving = state.copy(), np.full(len(state), -np.inf), np.arange(len(state))
    while len(moving):
        now = state[moving]
        s, usual = STATES[now], USUAL[now]
        step, moved = STATES - s[..., None], s @ gram
        square = (s * moved).sum(axis=1)[:, None, None] + 2 * step * moved[..., None]
        square += step**2 * np.diagonal(gram)[:, None]
        prior = usual.sum(axis=1)[:, None, None] + USUAL - usual[..., None]
        value = prior + gained(y, (s @ along)[:, None, None] + step * along[:, None], square, least)
        place = value.reshape(len(moving), -1).argmax(axis=1)
        highest = value.reshape(len(moving), -1)[np.arange(len(moving)), place]
        higher = highest > best[moving]
        moving, place = moving[higher], place[higher]
        best[moving] = highest[higher]
        state[moving, place // len(STATES)] = place % len(STATES)
    return best, STATES[state]


def gained(y: Array, along: Array, square: Array, least: float) -> Array:
    """½ n ln(E/E_s) − ½ ln n of sequences with the product ``along`` with y (n,) and the squared length ``square``,
    both of any shape and dimensionless."""
    n, energy = len(y), max(float(y @ y), FAINTEST)
    explained = np.where(square > FAINTEST * n, along**2 / np.maximum(square, FAINTEST), 0.0)
    remaining = np.maximum(energy - explained, max(least * n, FAINTEST * energy))
    return np.asarray(0.5 * n * np.log(np.maximum(energy / remaining, 1.0)) - 0.5 * np.log(n))
