"""The course of parity in time, made ready to be looked through: block by block, whitened, sensor by sensor.

A fault of sensor i moves p along V[i] and nowhere else; what lies across says how noisy and how moved the rest of the
recording is, which no fault of that sensor touches. So the covariance of a sensor's course (`scan`) comes from across
wherever there is an across (five sensors or more), and from the sounder part of the course itself.

What motion does to sound sensors is in that covariance: `nuisance` has lever arms, delays and shifts by vibration; the
body bends with load (`SLOPE`), and sensors drift smoothly while they warm (`DRIFT`).
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.ndimage import maximum_filter1d, median_filter
from scipy.special import chdtri

from estimator.arrays import eigh, unit
from estimator.parity.blocks import at_rest, resting, unclipped
from estimator.parity.ledger import Blocks, Ledger, pairs
from estimator.parity.nuisance import SIZE, UNSEEN_RATE, ParityNuisance, nuisance_of
from estimator.parity.reference import ParityReference
from estimator.parity.scan import MEMORIES, SOUND, Scan, block_variance, colour_of, remembered, scan_of
from estimator.session import Array

MOST = 600
"""Blocks looked through at most: all pairs of onset and end are tried. A longer recording's are joined two by two."""
SLOPE = 0.02
"""rad or relative; by which a sensor leans or stretches with load, or has changed since its calibration."""
FREE = 1e3
"""Noise of a block; size of the constant and of a smooth drift over the recording, which are not asked about here."""
DRIFT = (1, 2, 3)
"""Powers of time of a drift while warming."""
OWN = 3.0
"""Times, in sigma, that one sensor may be noisier than the others before it is suspected."""
FAINT = 0.25
"""Variance of longer memory that any sensor may have, as a part of a block's noise."""
ACTIVE = 1 / 3
"""Part of the blocks in which the vector changes most."""
BESIDE = 7
"""Blocks whose median a swing leaves: longer than a swing, shorter than what is asked about."""
MOST_SWINGS = 0.97
"""Part of them that must not stand out."""
TURNS = 4
"""Times that covariance and weights are taken in turns; they settle in three."""


@dataclass(frozen=True, eq=False)
class ParityCourse:
    """Parity in T blocks, of m sensors, d = m − 3."""

    reference: ParityReference
    blocks: Blocks
    start: int
    """Blocks of the ledger before the first of these, and ``span`` of them that make one."""
    span: int
    total: int
    """Blocks, with those left out."""
    white: Array
    """(d, d) W, 1/(m/s²) (1/(rad/s)): p·W has noise of one in a typical block."""
    p: Array
    """(T, d) parity without what stated positions feel, whitened."""
    halves: Array
    """(T, d) half the difference of the parity of the block's halves, whitened likewise."""
    signals: Array
    """(T, K) signals of motion and time that move parity; ``sizes`` (K, d, d) is the covariance of their size in
    whitened parity.
    """
    sizes: Array
    norm: float
    """g, m/s²; for gyros the root mean square rate, rad/s."""
    swings: Array | None
    """(T,) blocks a second, where nothing but the vector shows how the block swings; else None."""

    @cached_property
    def directions(self) -> Array:
        """(m, d) whitened parity of a unit change of each sensor."""
        return np.asarray(self.reference.parity @ self.white)

    @cached_property
    def felt(self) -> Array:
        """(T, m) input of each sensor as the others predict it, m/s² (rad/s)."""
        return self.reference.others(self.blocks.mean)

    def along(self, sensor: int) -> tuple[Array, Array, float]:
        """Unit direction (d,) of a sensor, basis (d, d − 1) of what lies across, and the length of the direction."""
        length = float(np.linalg.norm(self.directions[sensor]))
        u = self.directions[sensor] / max(length, np.finfo(float).tiny)
        return u, np.linalg.svd(u[None])[2][1:].T, length

    def fixed(self, basis: Array, sensor: int) -> Array:
        """(T, T) X·Λ·Xᵀ, the mean over the directions (d, n) of a basis; the load without the sensor's own reading."""
        size = np.einsum("dn,kde,en->k", basis, self.sizes, basis) / basis.shape[1]
        load, sizes = self.load(sensor)
        own = sizes**2 * float(((self.directions @ basis) ** 2).sum() / basis.shape[1])
        return np.asarray((self.signals * size) @ self.signals.T + (load * own) @ load.T)

    def vector(self, sensor: int) -> Array:
        """(T, 3) vector by the other sensors, m/s² (rad/s): a fault of the sensor does not bend it."""
        a = self.blocks.mean.copy()
        a[:, sensor] = self.felt[:, sensor]
        return self.reference.vector(a)

    def load(self, sensor: int) -> tuple[Array, Array]:
        """Signals (T, K) of the load, the sensor's own reading apart, and their sizes, m/s² (rad/s), for any sensor."""
        n = self.vector(sensor) / self.norm
        signals, sizes = [n, pairs(n)], [SLOPE * self.norm] * 3 + [SIZE * UNSEEN_RATE**2] * 6
        if self.swings is not None:
            signals.append(swing(n, self.swings))
            sizes += [SIZE] * 3
        return np.hstack(signals), np.array(sizes)

    def activity(self, sensor: int) -> Array:
        """(T,) change of the vector about a block, m/s² (rad/s)."""
        n = self.vector(sensor)
        around = np.linalg.norm(np.diff(np.pad(n, ((1, 1), (0, 0)), mode="edge"), axis=0), axis=1)
        return np.asarray(maximum_filter1d(np.maximum(around[1:], around[:-1]), 3))

    @cached_property
    def plain_variance(self) -> Array:
        """(T,) variance of an element of p in a block that moves as it does, whitened."""
        variance = block_variance(self.halves)
        activity = np.median([self.activity(k) for k in range(len(self.directions))], axis=0)
        return np.asarray(variance + stirring(self.p, variance, activity) * activity**2)

    def scan(self, sensor: int, *, noisier: Array | float = 0.0) -> Scan:
        """The course along one sensor; ``noisier`` (T,) adds to the variance of a block, whitened."""
        u, across, _ = self.along(sensor)
        x, h, fixed = self.p @ u, self.halves @ u, self.fixed(u[:, None], sensor)
        basis = across if across.shape[1] else u[:, None]
        variance = block_variance(self.halves @ basis)
        own = float(np.quantile(h**2 / variance, SOUND) / chdtri(1, 1 - SOUND))
        variance = variance * np.clip(own, 1.0, OWN**2)
        activity = self.activity(sensor)
        others = stirring(self.p @ basis, variance, activity)
        motion = max(others, min(stirring(x[:, None], variance, activity), OWN**2 * others))
        swung = motion * np.outer(activity, activity) * remembered(len(x), MEMORIES[0])
        colour = colour_of(self.p @ basis, variance, self.fixed(basis, sensor) + swung, 0.5)
        alone = colour_of(x[:, None], variance, fixed + swung, SOUND, wandering=True)
        most = OWN**2 * colour.sum() + FAINT * float(np.median(variance))
        colour = np.maximum(colour, alone * min(1.0, most / max(alone.sum(), most)))
        return scan_of(x, variance + noisier, colour, fixed + swung)


def stirring(courses: Array, variance: Array, activity: Array) -> float:
    """κ²: how far courses (T, n) leave their neighbours' median while the vector changes, by the square of its change
    (T,), beyond the noise (T,) of the blocks.

    A body that begins to turn swings its sensors in ways that the vector does not show; how far is learned here, from
    what most changes do.
    """
    beside = courses - median_filter(courses, size=(BESIDE, 1), mode="nearest")
    return stirred(beside, variance, activity, MOST_SWINGS)


def stirred(beside: Array, variance: Array, activity: Array, most: float) -> float:
    """κ² of what strays (T, n) from its neighbours, from the part ``most`` of it that does not stand out."""
    active = activity >= np.quantile(activity, 1 - ACTIVE)
    excess = (beside**2 - variance[:, None])[active] / np.maximum(activity[active], np.finfo(float).tiny)[:, None] ** 2
    return max(float(np.quantile(excess, most) / chdtri(1, 1 - most)), 0.0)


def course_of(ledger: Ledger, norm: float | None, rate: float) -> ParityCourse | None:
    """The course of a recording; None where too little of it can be used.

    Parameters
    ----------
    norm : g, m/s²; None for gyros.
    rate : of the samples, Hz.
    """
    reference = ledger.reference
    blocks, start, span = coarse(ledger.blocks())
    total = len(blocks)
    clean = unclipped(ledger, blocks)
    if clean.sum() < max(FEWEST, total / 2):
        return None
    rest = clean & resting(blocks, at_rest(blocks, clean), reference, norm, rate)
    blocks, rest = blocks.at(clean), rest[clean]
    nuisance = nuisance_of(blocks, rest, reference, norm, rate)
    p, halves = (blocks.mean - nuisance.known) @ reference.parity, blocks.halves @ reference.parity
    white = whitening(halves)
    signals, sizes = known_motion(blocks, nuisance, reference, white)
    size = norm or float(np.sqrt((reference.vector(blocks.mean) ** 2).sum(axis=1).mean()))
    swings = rate / blocks.samples if norm is not None and not blocks.spin.shape[1] else None
    return ParityCourse(
        reference, blocks, start, span, total, white, p @ white, halves @ white, signals, sizes, size, swings
    )


def coarse(blocks: Blocks) -> tuple[Blocks, int, int]:
    """The blocks, joined until they are no more than `MOST`; how many were left out first, and how many make one."""
    start, span = 0, 1
    while len(blocks) > MOST:
        odd = len(blocks) % 2
        start, span = start + odd * span, 2 * span
        later = blocks.at(np.arange(odd, len(blocks)))
        blocks = replace(later, first=later.first - later.first[0]).joined()
    return blocks, start, span


FEWEST = 24
"""Blocks; with fewer the noise is not known well enough to look for onsets."""


def whitening(halves: Array) -> Array:
    """(d, d) C^(−1/2) of the noise of a block's mean, from the differences (T, d) of its halves, m/s² (rad/s).

    Blocks beyond the 95 % quantile take no part; how noisy a block is, is taken out first.
    """
    d = halves.shape[1]
    floor = 1e-6 * float((halves**2).mean()) + np.finfo(float).tiny
    C = np.diag(np.median(halves**2, axis=0) / chdtri(1, 0.5) + floor)
    for _ in range(TURNS):
        root = np.linalg.cholesky(C)
        h = np.linalg.solve(root, halves.T).T
        variance = block_variance(h)
        square = (h**2).sum(axis=1) / variance
        kept = square <= chdtri(d, 0.05)
        scaled = halves[kept] / np.sqrt(variance[kept])[:, None]
        C = scaled.T @ scaled / max(int(kept.sum()), 1) + floor * np.eye(d)
    values, vectors = eigh(C)
    return np.asarray((vectors / np.sqrt(values)) @ vectors.T)


def known_motion(
    blocks: Blocks, nuisance: ParityNuisance, reference: ParityReference, white: Array
) -> tuple[Array, Array]:
    """Signals (T, K) and the covariances (K, d, d) of their sizes: time, and every unknown of the nuisance."""
    seen = reference.parity @ white
    t = 2.0 * (blocks.first - blocks.first[0]) / max(int(np.ptp(blocks.first)), 1) - 1.0
    drift = np.column_stack([np.ones(len(t)), *(t**k for k in DRIFT)])
    free = np.tile(FREE**2 * np.eye(white.shape[0]), (drift.shape[1], 1, 1))
    moved = nuisance.signals @ nuisance.coefficient.T
    own = np.einsum("kd,ke->kde", seen[nuisance.sensor], seen[nuisance.sensor])
    return np.hstack([drift, moved]), np.concatenate([free, own])


def swing(vectors: Array, often: Array) -> Array:
    """(T, 3) second derivative of the direction of vectors (T, 3), 1/s², from blocks ``often`` (T,) a second: as fast
    the block swings, and a sensor at r feels it as the acceleration ω̇ × r."""
    toward = unit(vectors)
    second = np.diff(toward, 2, axis=0, prepend=toward[:1], append=toward[-1:])
    return np.asarray(second * often[:, None] ** 2)
