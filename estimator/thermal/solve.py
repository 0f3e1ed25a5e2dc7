"""Least χ² of readings over temperature, under noise that is stated or estimated from the residuals.

Gauss and Newton with the step halved while χ² rises: the start is good to a few per cent. Where no noise is stated,
each sensor's is found as in `estimator.calibration.free.noise`: restricted likelihood, sensors of one block alike.
"""

from dataclasses import dataclass, replace

import numpy as np

from estimator.arrays import eigh
from estimator.calibration.free.information import unseen_below
from estimator.calibration.free.noise import FreeNoise
from estimator.session import Array
from estimator.thermal.model import State, ThermalEquations, ThermalRows, cost, linearise

MOST_ROUNDS = 40
"""Most rounds of a search, and most searches while the noise settles; five are usual."""
HALVINGS = 12
"""Most halvings of a step, before the search counts as ended."""
CONVERGED = 1e-6
"""Expected fall of χ² below which the search has ended: a thousandth of a standard error."""
SETTLED = 1e-3
"""Relative change of the noise below which it has settled."""


@dataclass(frozen=True, eq=False)
class ThermalFit:
    """The end of a search. P = m·p elements."""

    rows: ThermalRows
    """The rows, with the noise that was used."""
    state: State
    free: Array
    """(m, p) bool, elements that were estimated."""
    linear: ThermalEquations
    covariance: Array
    """(P, P), zero for what was not estimated."""
    chi2: float
    iterations: int
    converged: bool
    redundancy: Array
    """(m,) degrees of freedom that the residuals of each sensor keep."""

    @property
    def energy(self) -> Array:
        """(m,) squared residuals of each sensor, in sigmas."""
        return np.asarray((self.linear.residual**2).sum(axis=0))

    @property
    def dof(self) -> int:
        """Readings and stated directions, less what was estimated; the gauge takes three turns back."""
        R, m = self.rows.y.shape
        settings = np.unique(self.rows.setting).size if not self.rows.gyro.all() else 0
        held = int(self.free[:, -1].any() and not self.rows.prior.any())
        stated = int(np.count_nonzero(self.rows.prior))
        return R * m - int(self.free.sum()) - 2 * (settings - stated) + 3 * held


def is_determined(rows: ThermalRows, state: State, free: Array) -> bool:
    """Whether the rows determine all free elements (m, p) of the accelerometers."""
    chosen = (free & ~rows.gyro[:, None]).ravel()
    if not chosen.any():
        return True
    values = eigh(linearise(rows, state).information[np.ix_(chosen, chosen)])[0]
    return bool(values[0] > unseen_below(values[: max(int(chosen.sum()) - 3, 1)]))


def inverse_of(linear: ThermalEquations, free: Array) -> Array:
    """(P, P) covariance of the free elements (m, p) of one linearisation; zero elsewhere."""
    chosen = np.flatnonzero(free.ravel())
    F = linear.information[np.ix_(chosen, chosen)]
    size = 1 / np.sqrt(np.diagonal(F))
    covariance = np.zeros_like(linear.information)
    covariance[np.ix_(chosen, chosen)] = size[:, None] * np.linalg.inv(F * size[:, None] * size) * size
    return covariance


def search(rows: ThermalRows, state: State, free: Array) -> ThermalFit:
    """Least χ² over the free elements (m, p) from a state whose other elements stay."""
    state, iterations, converged = state.held(rows), 0, False
    chi2 = cost(rows, state)
    while True:
        linear = linearise(rows, state)
        covariance = inverse_of(linear, free)
        step = covariance @ linear.score
        settings = linear.settings(step)
        alone = (linear.setting_gradient * linear.settings(np.zeros_like(step))).sum()
        converged = bool(step @ linear.score + alone < CONVERGED)
        if converged or iterations == MOST_ROUNDS:
            break
        iterations += 1
        for halving in range(HALVINGS):
            part = 0.5**halving
            trial = state.stepped(part * step.reshape(free.shape), part * settings).held(rows)
            if (lower := cost(rows, trial)) <= chi2:
                break
        else:
            converged = True
            break
        state, chi2 = trial, lower
    return ThermalFit(
        rows, state, free, linear, covariance, chi2, iterations, converged, redundancy_of(rows, linear, covariance)
    )


def redundancy_of(rows: ThermalRows, linear: ThermalEquations, covariance: Array) -> Array:
    """(m,) degrees of freedom that are left in each sensor's residuals: readings less what the fit leans on them."""
    m, p = linear.local.shape[1:]
    taken = np.zeros(m)
    for local, shared, g in zip(linear.local, linear.shared, rows.setting, strict=True):
        through = shared @ linear.inverse[g]
        lean = -through @ linear.coupling[g].T
        lean.reshape(m, m, p)[range(m), range(m)] += local
        taken += (through * shared).sum(axis=1) + ((lean @ covariance) * lean).sum(axis=1)
    return len(rows.y) - taken


def search_with_noise(rows: ThermalRows, state: State, free: Array, *, stated: bool) -> ThermalFit:
    """The search, with the noise estimated on the way unless it is stated; ``rows.sigma`` is its first guess."""
    solved = search(rows, state, free)
    if stated or solved.redundancy.sum() < 1:
        return solved
    rows = replace(rows, sigma=rows.sigma * np.sqrt(of_kind(solved)))
    noise = FreeNoise(np.ones(rows.y.shape[1]), np.ones(rows.y.shape[1], dtype=bool))
    solved = search(rows, solved.state, free)
    for _ in range(MOST_ROUNDS):
        noise = noise.improved(solved.energy, np.maximum(solved.redundancy, 0.0))
        sigma = rows.sigma * np.sqrt(noise.factor)
        change = np.abs(sigma / solved.rows.sigma - 1).max()
        solved = search(replace(rows, sigma=sigma), solved.state, free)
        if change < SETTLED:
            break
    return solved


def of_kind(solved: ThermalFit) -> Array:
    """(m,) χ² per degree of freedom of all sensors of a sensor's kind: the first guess is of no kind in particular."""
    ratio = np.ones(len(solved.rows.gyro))
    for kind in (solved.rows.gyro, ~solved.rows.gyro):
        if kind.any():
            ratio[kind] = solved.energy[kind].sum() / max(float(solved.redundancy[kind].sum()), 1.0)
    return np.maximum(ratio, np.finfo(float).tiny)
