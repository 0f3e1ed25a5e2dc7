"""One deviation through time under every hypothesis and every strength of a random walk: exact normal likelihoods.

Readings of one component at n sessions, in tolerances T:

    z = B θ + a f + w + e,    e ~ N(0, diag σ²),    w ~ N(0, q²·min(t_i, t_j)),    θ flat

B holds the level and what is known to act (steps that were found, temperature), f is a shape of `shapes`, a its size.
The reference is the reading 0 ± its own uncertainty at its date. Whitened by C = diag σ² + q² W and freed of B,

    S = f̃ᵀf̃,  x = f̃ᵀz̃:    â = x/S ± S^(−1/2),    likelihood ratio exp(x²/2S)

and with a ~ N(0, s²) the Bayes factor is (1 + s²S)^(−1/2)·exp(s²x²/(2(1 + s²S))). The likelihood without a change is
the restricted one (Harville 1974). The level at the last session is the best linear unbiased prediction.
"""

from dataclasses import dataclass, field

import numpy as np

from estimator.health.error_laws import NORMAL
from estimator.health.shapes import Kind, Shapes
from estimator.session import Array

WALKS = np.array([0.0, 0.03, 0.06, 0.12, 0.25, 0.5, 1.0])
"""(7,) q of the nodes, T a root year: nothing at all, and from what a year hardly shows to what it spoils."""
PARTS = tuple(
    [(Kind.NONE, 0.0)]
    + [(Kind.JUMP, size) for size in (0.2, 0.6, 1.5)]
    + [(kind, rate) for kind in (Kind.LATE, Kind.START) for rate in (0.1, 0.3, 0.9)]
    + [(Kind.AGING, size) for size in (0.2, 0.6)]
    + [(Kind.SETTLING, size) for size in (0.3, 0.9)]
    + [(Kind.WARMTH, slope) for slope in (0.01, 0.03, 0.1)]
)
"""P kinds of change with one sigma of their sizes, in T, T a year or T per °C, from hardly seen to ruinous."""
PART_KINDS = np.array([kind for kind, _ in PARTS])
"""(P,) `Kind` of each."""
PART_SIZES = np.array([size for _, size in PARTS])
"""(P,) one sigma of the size, T, T a year or T per °C."""
CHANGES = tuple(dict.fromkeys(kind for kind, _ in PARTS if kind is not Kind.NONE))
"""Kinds with a shape, in the order of their parts."""
LEAST = 1e-6
"""Smallest sigma of a reading, T: below it nothing in a file is exact."""


@dataclass(frozen=True, eq=False)
class Readings:
    """One parameter through time; k = 1 component, of an axis 2."""

    time: Array
    """(n,) years since the first session, increasing."""
    value: Array
    """(n, k) deviations from the recorded reference, in tolerances."""
    sigma: Array
    """(n, k) standard uncertainties, in tolerances."""
    base: Array
    """(n, b) columns that act in every hypothesis, the first of them 1; any unit."""
    now: Array
    """(b,) values of these columns for the level that is forecast: after all steps, at the mean temperature."""
    tails: Array = field(default_factory=NORMAL.copy)
    """(4,) chance of each law of errors, of `FREEDOMS`; likelihoods take the first, chances of an alarm all."""


@dataclass(frozen=True, eq=False)
class Fits:
    """All k components at Q strengths of the walk, about H shapes."""

    family: Shapes
    walks: Array
    """(Q,) T a root year."""
    span: float
    """Years from the first session to the last."""
    log_likelihood: Array
    """(Q, k) without a change, up to a constant that all fits of a component share."""
    z: Array
    """(Q, k, n) whitened readings, freed of the base; dimensionless."""
    shapes: Array
    """(Q, k, n, H) whitened shapes, freed of the base; per unit of size."""
    information: Array
    """(Q, k, H) S, per unit of size squared."""
    score: Array
    """(Q, k, H) x, per unit of size."""
    gain: Array
    """(Q, k, n) weights of the readings in the last level, dimensionless."""
    variance: Array
    """(Q, k) variance of that level, sizes known; T²."""
    root: Array
    """(Q, k, n, n) lower triangular, C = root·rootᵀ, T."""
    frame: Array
    """(Q, k, n, b) orthonormal, what the whitened base spans."""

    def log_evidence(self) -> Array:
        """(Q, P) log marginal likelihood at each strength of the walk, of each part, without unit."""
        none = self.log_likelihood.sum(axis=1)
        ratios = [np.zeros((1, len(none)))]
        for kind in CHANGES:
            log_weighted = self.log_ratios(kind) + np.log(self.family.share[self.of_kind(kind)])
            ratios.append(
                np.logaddexp.reduce(log_weighted, axis=2) if log_weighted.shape[2] else np.zeros(log_weighted.shape[:2])
            )
        return np.asarray((none + np.concatenate(ratios)).T)

    def log_ratios(self, kind: Kind) -> Array:
        """(S, Q, H') log Bayes factor of the shapes of a kind at each of its sizes against no change; no unit."""
        members, s2 = self.of_kind(kind), PART_SIZES[kind == PART_KINDS][:, None, None, None] ** 2
        spread = s2 * self.information[..., members]
        return 0.5 * np.asarray(s2 * self.score[..., members] ** 2 / (1 + spread) - np.log1p(spread)).sum(axis=2)

    def of_kind(self, kind: Kind) -> Array:
        """(H',) places of the shapes of a kind."""
        return np.flatnonzero(self.family.kind == kind)


def fits(readings: Readings, family: Shapes, walks: Array = WALKS) -> Fits:
    """Every component at every one of ``walks`` (Q,), T a root year."""
    n, columns = len(readings.time), family.columns.shape[1]
    wandering = np.minimum.outer(readings.time, readings.time)
    walk = walks[:, None, None, None] ** 2 * wandering
    noise = np.eye(n) * np.maximum(readings.sigma.T, LEAST)[:, None, :] ** 2
    root = np.linalg.cholesky(noise + walk)
    last = np.broadcast_to(walk[..., [-1]], (*root.shape[:3], 1))
    value = np.broadcast_to(readings.value.T[..., None], last.shape)
    shared = np.concatenate([family.columns, readings.base], axis=1)
    shared = np.broadcast_to(shared, (*root.shape[:2], *shared.shape))
    white = np.linalg.solve(root, np.concatenate([value, last, shared], axis=-1))
    last, base = white[..., [1]], white[..., 2 + columns :]
    frame, corner = np.linalg.qr(base)
    free = np.delete(white[..., : 2 + columns], 1, axis=-1)
    free = free - frame @ (_turned(frame) @ free)
    z, shapes = free[..., 0], free[..., 1:]
    # the last level = now·θ̂ + lastᵀ(z̃ − B̃ θ̂), with θ̂ = R⁻¹ Qᵀ z̃
    along = np.linalg.solve(_turned(corner), readings.now[:, None] - _turned(base) @ last)
    return Fits(
        family=family,
        walks=walks,
        span=float(readings.time[-1] - readings.time[0]),
        log_likelihood=-_log_diagonal(root) - _log_diagonal(corner) - (z**2).sum(axis=-1) / 2,
        z=z,
        shapes=shapes,
        information=(shapes**2).sum(axis=-2),
        score=(z[..., None, :] @ shapes)[..., 0, :],
        gain=np.linalg.solve(_turned(root), frame @ along + last)[..., 0],
        variance=np.maximum(walk[..., -1, -1] + ((along**2).sum(axis=-2) - (last**2).sum(axis=-2))[..., 0], 0.0),
        root=root,
        frame=frame,
    )


def _turned(matrices: Array) -> Array:
    return np.swapaxes(matrices, -1, -2)


def _log_diagonal(matrices: Array) -> Array:
    return np.asarray(np.log(np.abs(np.diagonal(matrices, axis1=-2, axis2=-1))).sum(axis=-1))
