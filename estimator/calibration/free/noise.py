"""The noise of readings in unknown orientations where the file states none, and what that makes of the uncertainty.

Theory
------
Restricted likelihood, one variance φ_i a sensor (relative to the first guess). In readings of variance one, with P the
projection on what parameters and orientations leave, E_i the squared residuals of sensor i and A_i the identity on its
readings, the score and the information of ln φ are

    (E_i − f_i)/2,    f_i = tr(P A_i)          T_ij/2,    T_ij = tr(P A_i P A_j)

(Patterson & Thompson 1971; Förstner calls f_i the redundancy). The projection falls apart as I − S D⁻¹Sᵀ − W̃ C W̃ᵀ: the
turns of each orientation and the parameters.

Sensors of one block are alike: as on the stand (`estimator.calibration.noise`), φ_i is taken as drawn about a common
φ₀ with d₀ = `ALIKE` degrees of freedom. The largest posterior has E_i − f_i + d₀(φ₀/φ_i − 1) = 0 and φ₀ the harmonic
mean of the φ_i, so few degrees of freedom give one pooled variance and many give each sensor its own. A sensor whose
scatter contradicts that of the others keeps its own.

Degrees of freedom of an uncertainty (Satterthwaite; Giesbrecht & Burns 1985, Biometrics 41, 477): with g_i = ∂C/∂ln φ_i
of a variance C, and M = T + d₀(B − b bᵀ/n) twice the posterior information, b marking the n that borrow,

    ν = C² / (gᵀ M⁻¹ g)

which is the common ν = Σ f_i where all noise is pooled.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy import special

from estimator.calibration.free.information import Information
from estimator.calibration.free.model import ModelRows, Unknowns, linearise
from estimator.calibration.free.schedule import Mask
from estimator.calibration.free.solve import NO_FREEDOM, Solution, search
from estimator.calibration.noise import ALIKE, CONTRADICTED
from estimator.session import Array

ROUNDS = 25
"""Rounds of search and noise; the last is taken where they do not settle."""
SETTLED = 1e-3
"""Relative change of the noise between rounds below which it has settled: far below what residuals tell of a sigma."""
MOST_ITERATIONS = 600
"""Most iterations of all searches together while the noise settles."""

TINY = float(np.finfo(float).tiny)
"""Keeps readings without any residual from a division by nothing."""

LEAST_NOISE = 1e-12
"""Dimensionless; readings are not better than rounding."""

LEAST_FREEDOM = 1e-6
"""Degrees of freedom of a sensor's own scatter below which there is none to judge by."""


@dataclass(frozen=True, eq=False)
class ProjectedNoise:
    """The parts of readings of variance one that the fit absorbs. R orientations, m sensors, F directions seen."""

    turns: Array
    """(R, m, m) S D⁻¹Sᵀ, the part absorbed by the orientation's own turns."""
    lean: Array
    """(R, m, F) dependence of the fitted value of each reading on the seen directions."""
    residual: Array
    """(R, m) residuals in sigmas."""
    takes_part: Array
    """(R, m) bool"""

    @property
    def redundancy(self) -> Array:
        """(R, m) part of each reading's variance that the fit leaves in its residual, without unit."""
        direct = np.diagonal(self.turns, axis1=1, axis2=2)
        return np.where(self.takes_part, np.clip(1.0 - direct - (self.lean**2).sum(axis=-1), 0.0, 1.0), 0.0)

    @property
    def shares(self) -> Array:
        """(m, F, F) information of each sensor's readings on the seen directions; the sum is the identity."""
        by_sensor = np.swapaxes(self.lean, 0, 1)
        return np.swapaxes(by_sensor, 1, 2) @ by_sensor

    @property
    def overlap(self) -> Array:
        """(m, m) T, without unit."""
        complement = np.eye(self.turns.shape[1]) * self.takes_part[:, None, :] - self.turns
        flat = self.shares.reshape(len(complement[0]), -1)
        return (complement**2 - 2.0 * complement * (self.lean @ np.swapaxes(self.lean, 1, 2))).sum(
            axis=0
        ) + flat @ flat.T


def projected(rows: ModelRows, unknowns: Unknowns, knowledge: Information) -> ProjectedNoise:
    """Splits the readings into absorbed parts and residuals, under the noise of ``rows``."""
    linear = linearise(rows, unknowns)
    through = (linear.shared[:, :, None, :] @ linear.inverse[:, None])[:, :, 0, :]
    root = scaled(knowledge)
    moved = np.einsum("rma,rpa->rmp", through, linear.coupling) @ root
    local = np.einsum("rmi,mif->rmf", linear.local, root.reshape(rows.y.shape[1], 5, -1))
    return ProjectedNoise(through @ np.swapaxes(linear.shared, 1, 2), local - moved, linear.residual, rows.takes_part)


def scaled(knowledge: Information) -> Array:
    """(5 m, F) the seen directions, each one standard deviation long, dimensionless."""
    return knowledge.seen * np.sqrt(knowledge.variances)


@dataclass(frozen=True, eq=False)
class FreeNoise:
    """Variances of m sensors relative to the first guess."""

    factor: Array
    """(m,) φ, without unit."""
    borrows: Mask
    """(m,) whether a sensor's noise is taken as like the others'."""

    @property
    def common(self) -> float:
        """φ₀."""
        return float(1.0 / np.mean(1.0 / self.factor[self.borrows])) if self.borrows.any() else 1.0

    def improved(self, energy: Array, freedom: Array) -> "FreeNoise":
        """One round, from energies (m,) and degrees of freedom (m,), without unit: the common scale, then each sensor.

        The common scale first, because it settles at once; one by one, each held by the others, it would creep.
        """
        scale = energy.sum() / float(freedom.sum())
        energy, factor = energy / max(scale, TINY), self.factor * scale
        moved = FreeNoise(factor, self.borrows)
        usual = special.fdtri(np.maximum(freedom, 1.0), ALIKE, 1 - CONTRADICTED) * moved.common
        borrows = self.borrows & (energy * factor < usual * np.maximum(freedom, 1.0))
        pull = np.where(borrows, ALIKE, 0.0)
        held = energy + pull * FreeNoise(factor, borrows).common / np.maximum(factor, TINY)
        return FreeNoise(factor * held / np.maximum(freedom + pull, LEAST_FREEDOM), borrows)


def search_with_noise(rows: ModelRows, unknowns: Unknowns, quadratic: bool) -> Solution:
    """The search with the noise estimated on the way; ``rows.sigma`` gives the relative weights to begin with.

    Without a degree of freedom the noise cannot be estimated, and the first guess stays.
    """
    solution, m = search(rows, unknowns, quadratic), rows.y.shape[1]
    iterations, noise = solution.iterations, FreeNoise(np.ones(m), np.ones(m, dtype=bool))
    projection = projected(solution.rows, solution.unknowns, solution.knowledge)
    for _ in range(ROUNDS if projection.redundancy.sum() > NO_FREEDOM else 0):
        noise = noise.improved((projection.residual**2).sum(axis=0), projection.redundancy.sum(axis=0))
        sigma = np.maximum(rows.sigma * np.sqrt(noise.factor), LEAST_NOISE)
        taking = rows.takes_part
        change = np.abs(sigma[taking] / solution.rows.sigma[taking] - 1.0).max()
        solution = search(rows.weighted(sigma), solution.unknowns, quadratic)
        projection = projected(solution.rows, solution.unknowns, solution.knowledge)
        iterations += solution.iterations
        if change < SETTLED or iterations > MOST_ITERATIONS:
            break
    return replace(solution, iterations=iterations, freedom=float(projection.redundancy.sum()), borrows=noise.borrows)


def freedom_of(solution: Solution, change: Array) -> Array:
    """(P,) degrees of freedom of the variances of change·elements; change (P, 5 m), without unit.

    Infinite where no noise that was estimated has a part, NaN where the noise cannot be estimated.
    """
    if not solution.knows_noise:
        return np.full(len(change), np.nan)
    if solution.borrows is None:
        return np.full(len(change), solution.freedom)
    projection = projected(solution.rows, solution.unknowns, solution.knowledge)
    moves = change @ scaled(solution.knowledge)
    variance = (moves**2).sum(axis=-1)
    gradient = np.stack([((moves @ share) * moves).sum(axis=-1) for share in projection.shares], axis=-1)
    b = solution.borrows.astype(float)
    pull = ALIKE * (np.diag(b) - np.outer(b, b) / max(b.sum(), 1.0))
    doubt = ((gradient @ np.linalg.pinv(projection.overlap + pull, hermitian=True)) * gradient).sum(axis=-1)
    return np.where(doubt > 0, variance**2 / np.where(doubt > 0, doubt, 1.0), np.inf)
