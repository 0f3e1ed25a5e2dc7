"""One deviation through time under every hypothesis and every strength of a random walk: exact normal likelihoods.

Readings of one component at n sessions, in tolerances T:

    z = B θ + a f + w + e,    e ~ N(0, diag σ²),    w ~ N(0, q²·min(t_i, t_j)),    θ flat

B holds the level and what is known to act (steps that were found, temperature), f is a shape of `shapes`, a its size.
The reference is the reading 0 ± its own uncertainty at its date. Whitened by C = diag σ² + q² W and freed of B,

    S = f̃ᵀf̃,  x = f̃ᵀz̃:    â = x/S ± S^(−1/2),    likelihood ratio exp(x²/2S)

and with a ~ N(0, s²) the Bayes factor is (1 + s²S)^(−1/2)·exp(s²x²/(2(1 + s²S))). The likelihood without a change is
the restricted one (Harville 1974). The level at the last session is the best linear unbiased prediction.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_triangular

from estimator.health.shapes import Kind, Shapes
from estimator.session import Array

WALKS = np.array([0.0, 0.03, 0.06, 0.12, 0.25, 0.5, 1.0])
"""(7,) q of the nodes, T a root year: nothing at all, and from what a year hardly shows to what it spoils."""
PARTS = tuple(
    [(Kind.NONE, 0.0)]
    + [(Kind.JUMP, size) for size in (0.2, 0.6, 1.5)]
    + [(kind, rate) for kind in (Kind.LATE, Kind.START) for rate in (0.1, 0.3, 0.9)]
    + [(Kind.AGING, size) for size in (0.2, 0.6)]
)
"""P kinds of change with one sigma of their sizes, in T or T a year, from hardly seen to ruinous."""
PART_KINDS = np.array([kind for kind, _ in PARTS])
"""(P,) `Kind` of each."""
PART_SIZES = np.array([size for _, size in PARTS])
"""(P,) one sigma of the size, T or T a year."""
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
    """(n, b) columns that act whatever else does, the first of them 1; any unit."""
    now: Array
    """(b,) the same for the level that is forecast: after all steps, at the mean temperature."""


@dataclass(frozen=True, eq=False)
class Fit:
    """One component at one strength of the walk."""

    log_likelihood: float
    """Without a change, up to a constant that all fits of the component share."""
    z: Array
    """(n,) whitened readings, freed of the base; dimensionless."""
    shapes: Array
    """(n, H) whitened shapes, freed of the base; per unit of size."""
    information: Array
    """(H,) S, per unit of size squared."""
    score: Array
    """(H,) x, per unit of size."""
    gain: Array
    """(n,) weights of the readings in the last level, dimensionless."""
    variance: float
    """Of that level, sizes known; T²."""
    root: Array
    """(n, n) lower triangular, C = root·rootᵀ, T."""
    frame: Array
    """(n, b) orthonormal, what the whitened base spans."""


def fit(readings: Readings, component: int, q: float, family: Shapes) -> Fit:
    """One component of the readings at a walk of ``q``, T a root year."""
    t, sigma = readings.time, np.maximum(readings.sigma[:, component], LEAST)
    walk = q**2 * np.minimum.outer(t, t)
    root = np.linalg.cholesky(np.diag(sigma**2) + walk)
    stacked = np.concatenate([readings.value[:, [component]], family.columns, readings.base, walk[:, [-1]]], axis=1)
    white = solve_triangular(root, stacked, lower=True)
    z, f, base, last = white[:, 0], white[:, 1:-1], white[:, 1:-1], white[:, -1]
    f, base = f[:, : family.columns.shape[1]], base[:, family.columns.shape[1] :]
    frame, corner = np.linalg.qr(base)
    z, f = z - frame @ (frame.T @ z), f - frame @ (frame.T @ f)
    # the last level = now·θ̂ + lastᵀ(z̃ − B̃ θ̂), with θ̂ = R⁻¹ Qᵀ z̃
    along = solve_triangular(corner, readings.now - base.T @ last, trans="T")
    gain = solve_triangular(root, frame @ along + last, lower=True, trans="T")
    return Fit(
        log_likelihood=-float(np.log(np.diag(root)).sum() + np.log(np.abs(np.diag(corner))).sum() + z @ z / 2),
        z=z,
        shapes=f,
        information=np.einsum("nh,nh->h", f, f),
        score=z @ f,
        gain=gain,
        variance=max(float(walk[-1, -1] - last @ last + along @ along), 0.0),
        root=root,
        frame=frame,
    )


@dataclass(frozen=True, eq=False)
class Fits:
    """All components at all strengths of the walk."""

    family: Shapes
    span: float
    """Years from the first session to the last."""
    by_walk: tuple[tuple[Fit, ...], ...]
    """Q times k."""

    def log_evidence(self) -> Array:
        """(Q, P) log marginal likelihood at each strength of the walk, of each part, without unit."""
        rows = []
        for parts in self.by_walk:
            none = sum(fit.log_likelihood for fit in parts)
            ratios = [self._mean_ratio(self.log_ratios(parts, p), p) for p in range(1, len(PARTS))]
            rows.append(none + np.array([0.0, *ratios]))
        return np.array(rows)

    def log_ratios(self, parts: tuple[Fit, ...], part: int) -> Array:
        """(H',) log Bayes factor of the shapes of a part's kind against no change; dimensionless."""
        of_kind, s2 = self.family.kind == PART_KINDS[part], PART_SIZES[part] ** 2
        total = np.zeros(int(of_kind.sum()))
        for one in parts:
            information, score = one.information[of_kind], one.score[of_kind]
            total += 0.5 * s2 * score**2 / (1 + s2 * information) - 0.5 * np.log1p(s2 * information)
        return total

    def _mean_ratio(self, log_ratios: Array, part: int) -> float:
        if not log_ratios.size:
            return 0.0
        share = self.family.share[self.family.kind == PART_KINDS[part]]
        top = log_ratios.max()
        return float(top + np.log(np.sum(share * np.exp(log_ratios - top))))


def fits(readings: Readings, family: Shapes) -> Fits:
    """At every strength of the walk."""
    components = range(readings.value.shape[1])
    by_walk = tuple(tuple(fit(readings, j, float(q), family) for j in components) for q in WALKS)
    return Fits(family, float(readings.time[-1] - readings.time[0]), by_walk)
