"""Readings of a sensor that come late from one moment on.

A sensor that answers δ late adds −δ·ẋ to its reading, ẋ the rate at which what it feels changes, which the others say.
So parity goes with ẋ along V[i], and along nothing else. From sums over the quarters of block b, over which vibration
has averaged out, of parity p, less its mean over the blocks beside, which leaves bias, load and drift out, and of ẋ,

    M_b = Σ p·ẋ,   N_b = Σ ẋ²,   M_b = −δ·N_b·V[i] + noise of variance s²·N_b + κ²·N_b²

y_b = M_b/√N_b is a course of even noise along V[i], in which lateness is a shift of the shape √N_b. What has always
been late is no fault, and free. How far y strays from its neighbours tells its noise; across V[i] it also tells how far
motion stirs it (κ).
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import median_filter, uniform_filter1d

from estimator.parity.course import BESIDE, FREE, ParityCourse, stirred
from estimator.parity.results import DELAY
from estimator.parity.scan import MEMORIES, block_variance, scan_of
from estimator.parity.shapes import FaultShape, best_onset, onsets
from estimator.session import Array

CENTRED = 5
"""Blocks over whose mean parity is centred: a manoeuvre's length."""
MOVES = 0.1
"""Energy of ẋ, relative to its mean, from which a block is in motion."""
TYPICAL = 0.8
"""Part of the blocks in motion that must not stand out: a manoeuvre is long, so that few of many stir most."""
ENOUGH = 4
"""Blocks that tell alike how late a sensor was, or is."""
LONGEST, TRIED = 1.0, 201
"""s of a delay; how many are tried."""
ARM = 0.01
"""s; what a lever arm of a decimetre looks like in manoeuvres of a second, ω̇·r of g·ω."""
LEAST = 1e-3
"""Least energy of ẋ in a block, relative to its mean: the rounding of the sums."""


@dataclass(frozen=True, eq=False)
class Lateness:
    """The best onset of one sensor, by number. T blocks, d = m − 3."""

    sensor: int
    shape: FaultShape
    seen: Array
    """(d,) size of the change in whitened parity, in sigmas of y."""
    delay: float
    """s, and one sigma of the noise."""
    sigma: float

    @property
    def z(self) -> float:
        """Sigmas that it is later than before, by noise and by motion; below zero if it is earlier."""
        return self.delay / float(np.hypot(self.sigma, ARM))

    @property
    def across(self) -> float:
        """z² of what does not lie along the sensor."""
        return float(self.seen @ self.seen) - self.shape.square


def lateness(course: ParityCourse, rate: float) -> list[Lateness]:
    """The best onset of every sensor that shows enough of motion before and after one; samples at ``rate`` Hz."""
    blocks, (T, m) = course.blocks, course.blocks.mean.shape
    quarters = np.moveaxis(blocks.mean[:, :, None] + blocks.quarters, 1, 2)
    beside = uniform_filter1d(blocks.mean, CENTRED, axis=0, mode="nearest")
    p = (quarters - beside[:, None]) @ course.reference.parity @ course.white
    felt = course.reference.others(quarters.reshape(4 * T, m))
    change = changes(felt, 4 * np.flatnonzero(np.diff(blocks.first) > 1)).reshape(quarters.shape)
    M, N = np.einsum("tqd,tqi->tid", p, change), (change**2).sum(axis=1)
    quarter = float(blocks.samples[0]) / 4 / rate
    found = (_of(course, i, M[:, i], N[:, i], 2 * quarter) for i in range(m))
    return [_as_long(one, course, p.reshape(4 * T, -1), felt[:, one.sensor], quarter) for one in found if one]


def _as_long(one: Lateness, course: ParityCourse, p: Array, felt: Array, quarter: float) -> Lateness:
    """Refines the delay to that which explains parity of quarters (4T, d) best: ẋ·δ falls short where motion is quicker
    than δ.

    ``felt`` (4T,) is what the others say of the sensor, quarter by ``quarter``, s.
    """
    u, _, length = course.along(one.sensor)
    t = np.arange(len(felt))
    after = np.repeat(one.shape.shape > 0, 4)
    delays = np.linspace(0.0, LONGEST / quarter, TRIED)
    late = np.stack([np.interp(t - delay, t, felt) - felt for delay in delays])
    late -= uniform_filter1d(late, 4 * CENTRED, axis=1, mode="nearest")
    left = ((p @ u / length - late)[:, after] ** 2).sum(axis=1)
    delay = float(delays[left.argmin()]) * quarter
    return replace(one, delay=delay, sigma=one.sigma * delay / one.delay) if delay > one.delay > 0 else one


def changes(x: Array, gaps: Array) -> Array:
    """(4T, m) change of means of quarters (4T, m), their unit half a block; 0 on either side of the gaps, which begin
    after the fourth quarter from these places."""
    change = np.zeros_like(x)
    change[1:-1] = x[2:] - x[:-2]
    change[gaps + 3] = change[gaps + 4] = 0.0
    return change


def moving(course: ParityCourse, told: Array) -> Array:
    """(n,) onsets, in blocks, with at least `ENOUGH` informative blocks on either side; ``told`` (T,) weighs each
    block.
    """
    total = np.concatenate([[0.0], np.cumsum(told)])
    square = np.concatenate([[0.0], np.cumsum(told**2)]) + np.finfo(float).tiny
    before = total**2 / square
    after = (total[-1] - total) ** 2 / (square[-1] - square + np.finfo(float).tiny)
    tried = onsets(course)
    enough = np.minimum(before, after) >= ENOUGH
    return tried[enough[np.searchsorted(course.blocks.first, np.floor(tried))]]


def _of(course: ParityCourse, sensor: int, M: Array, N: Array, half: float) -> Lateness | None:
    """One sensor's, from M (T, d) and N (T,); half a block is so many s."""
    root = np.sqrt(N + LEAST * N.mean() + np.finfo(float).tiny)
    shape, y = N / root, M / root[:, None]
    u, across, length = course.along(sensor)
    strayed = y - shape[:, None] * median_filter(y / root[:, None], size=(BESIDE, 1), mode="nearest")
    sides = [strayed @ basis for basis in (u[:, None], across) if basis.size]
    variance = np.maximum.reduce([block_variance(side) for side in sides])
    moves = shape**2 >= MOVES * float((shape**2).mean())
    motion = stirred(sides[-1][moves], variance[moves], shape[moves], TYPICAL)
    free = FREE**2 * float(np.median(variance)) / max(float((shape**2).mean()), np.finfo(float).tiny)
    noise = variance + motion * shape**2
    scan = scan_of(y @ u, noise, np.zeros(len(MEMORIES)), free * np.outer(shape, shape))
    tried = moving(course, shape**2 / noise)
    if not len(tried):
        return None
    best = best_onset(course, scan, DELAY, shape, tried)
    g = scan.whitened(best.shape[:, None])[:, 0]
    seen = g @ scan.whitened(y) / max(float(np.linalg.norm(g)), np.finfo(float).tiny)
    size, sigma = (x * half / length for x in scan.size(best.shape))
    return Lateness(sensor, best, seen, -size, sigma)
