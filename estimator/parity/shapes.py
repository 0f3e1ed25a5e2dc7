"""The shapes of a sensor's course when it fails from one moment on, and the choice among them.

The onset of every kind is tried at every quarter of a block, and so dated: its error is that of the likelihood over the
onsets. One that comes and goes is found by turning stretches on and off, each while that explains the course better.
"""

from dataclasses import dataclass

import numpy as np

from estimator.parity.course import ParityCourse
from estimator.parity.results import DELAY, GAIN, INTERMITTENT, RAMP, STEP
from estimator.parity.scan import SHORTEST, Scan
from estimator.session import Array

PARTS = 4
"""Parts of a block, at which an onset is tried."""
SIMPLER = 6.0
"""z² by which a kind must explain the course better than a plain step: odds of twenty."""
TOGGLE = 25.0
"""z² that a return, or a relapse, must explain: one of all pairs of moments by chance in a thousand recordings."""
CERTAIN = 0.9
"""Share of z² that counts: what more returns add to a large change may be motion meanwhile."""
TOGGLES = 60
"""Stretches at most."""


@dataclass(frozen=True, eq=False)
class FaultShape:
    """The best shape of one kind."""

    kind: str
    square: float
    """z²"""
    since: float
    """Blocks of the course, and one sigma of it."""
    since_sigma: float
    until: float | None
    shape: Array
    """(T,)"""
    toggles: int = 0

    @property
    def worth(self) -> float:
        """z² less what its returns must bring."""
        return self.square if not self.toggles else CERTAIN * self.square - TOGGLE * self.toggles


def entered(course: ParityCourse, onsets: Array) -> Array:
    """(T, n) share of every block that lies after the onsets (n,), blocks."""
    return np.clip(course.blocks.first[:, None] + 1.0 - onsets, 0.0, 1.0)


def onsets(course: ParityCourse) -> Array:
    """(n,) moments that are tried, blocks: not the first blocks, before which too little would be sound."""
    return np.arange(PARTS * SHORTEST, PARTS * course.total) / PARTS


def best_onset(
    course: ParityCourse, scan: Scan, kind: str, factor: Array | None, tried: Array | None = None
) -> FaultShape:
    """The best onset of a plain kind: a shift, its integral, or a shift of the sensor's input (T,) times a size; out of
    all onsets, or of those tried (n,), blocks.
    """
    tried = onsets(course) if tried is None else tried
    if kind == RAMP:
        shapes = 0.5 * entered(course, tried) ** 2 + np.maximum(course.blocks.first[:, None] - tried, 0.0)
    else:
        shapes = entered(course, tried) * (1.0 if factor is None else factor[:, None])
    square = scan.ratios(shapes) ** 2
    best = int(square.argmax())
    weight = np.exp(0.5 * (square - square[best]))
    mean = float(weight @ tried / weight.sum())
    spread = float(np.sqrt(weight @ (tried - mean) ** 2 / weight.sum()))
    sigma = float(np.hypot(spread, 1.0 / (PARTS * np.sqrt(3))))
    return FaultShape(kind, float(square[best]), mean, sigma, None, shapes[:, best])


def coming_and_going(course: ParityCourse, scan: Scan, first: int, until: int) -> FaultShape:
    """Stretches of one size, from one of them on."""
    T = len(scan.white)
    g = scan.whitened(np.tri(T))
    N = np.zeros((T + 1, T + 1))
    N[:T, :T] = g.T @ g
    norm = np.diag(N)[:, None] + np.diag(N) - 2 * N
    on = np.zeros(T, dtype=bool)
    on[first:until] = True
    toggles = 1 if until < T else 0
    later = np.triu(np.ones((T + 1, T + 1), dtype=bool), 1)
    for _ in range(TOGGLES):
        size, _ = scan.size(on.astype(float))
        left = scan.white - size * scan.whitened(on[:, None].astype(float))[:, 0]
        c = np.append(g.T @ left, 0.0)
        count = np.append(0, np.cumsum(on))
        inside = count - count[:, None]
        length = np.arange(T + 1) - np.arange(T + 1)[:, None]
        sign = np.where(inside == 0, 1.0, np.where(inside == length, -1.0, 0.0))
        gain = np.where(later & (sign != 0), 2 * sign * size * (c[:, None] - c) - size**2 * norm, -np.inf)
        a, b = np.unravel_index(gain.argmax(), gain.shape)
        if gain[a, b] < TOGGLE:
            break
        on[a:b] = ~on[a:b]
        toggles += 1
    on ^= on[0]
    square = float(scan.ratios(on[:, None].astype(float))[0] ** 2)
    where = np.flatnonzero(on)
    begin, last = float(course.blocks.first[where[0]]), float(course.blocks.first[where[-1]] + 1)
    end = None if where[-1] == T - 1 else last
    return FaultShape(INTERMITTENT, square, begin, 0.5, end, on.astype(float), toggles)


def lag(course: ParityCourse, sensor: int) -> Array:
    """(T,) loss of a sensor that responds one sample late, m/s² (rad/s)."""
    return np.asarray(-course.blocks.gain @ course.reference.axes[sensor] / course.blocks.samples)


def shape_of(course: ParityCourse, scan: Scan, sensor: int, z: Array) -> FaultShape:
    """The kind that explains a sensor's course best."""
    felt = course.felt[:, sensor] + course.reference.bias[sensor]
    late = lag(course, sensor)
    plain = best_onset(course, scan, STEP, None)
    tried = [best_onset(course, scan, RAMP, None)]
    if np.ptp(felt) > 0:
        tried += [best_onset(course, scan, GAIN, felt)]
        slow = best_onset(course, scan, DELAY, late)
        tried += [slow] if scan.size(slow.shape)[0] > 0 else []
    began = int(np.searchsorted(course.blocks.first, np.floor(plain.since)))
    place = np.unravel_index(np.abs(z).argmax(), z.shape)
    starts = ((began, len(scan.white)), (int(place[0]), int(place[1])))
    tried += [s for s in (coming_and_going(course, scan, *start) for start in starts) if s.toggles]
    best = max(tried, key=lambda s: s.worth)
    return best if best.worth > plain.square + SIMPLER else plain
