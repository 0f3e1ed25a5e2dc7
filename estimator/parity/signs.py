"""Signs of a fault beside its mean: two sensors exchanged, noise that grows.

exchanged  with the readings of two exchanged back, parity from some moment on is as quiet as before it. Compared with
           the readings as they are by likelihood, and with any course of one sensor alone.
noise      parity flutters from sample to sample with the noise of the sensors, and with vibration, by what the other
           sensors feel of it. What is beyond that, in logarithms, steps up.
           Where it goes with what the others feel, it is no noise but motion that comes late.
"""

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.ndimage import median_filter
from scipy.optimize import nnls
from scipy.special import chdtri

from estimator.parity.course import FREE, ParityCourse
from estimator.parity.results import NOISE
from estimator.parity.scan import NEAR, SHORTEST, Scan, colour_of, scan_of
from estimator.parity.shapes import FaultShape, best_onset
from estimator.session import Array

SURE = 60.0
"""χ² by which exchanged readings must explain more: of all pairs and onsets one by chance in 10⁹ recordings."""
LEFT = 0.2
"""Share of the energy of parity that an exchange may leave at most, and that one sensor's course must leave more."""
GROWN = 3.0
"""Factor by which the variance must grow: motion of a new kind makes as much out of what is sound."""
FEW = 5
"""Blocks that show a level."""
FOLLOWS = 0.5
"""Grown noise is taken for motion where its ratio to the motion of the others scatters, in logarithms, by at most this
part of its own scatter."""


@dataclass(frozen=True, eq=False)
class Exchange:
    """Two sensors, by number, since when, blocks."""

    pair: tuple[int, int]
    since: float
    square: float
    """χ² that it explains."""


def exchange_of(course: ParityCourse) -> Exchange | None:
    """The likeliest pair, if one is likely."""
    V, reference = course.reference.parity, course.reference
    if V.shape[1] < 2:
        return None
    a = course.blocks.mean
    u = reference.readings(a)
    weight = 1.0 / course.plain_variance
    before = (course.p**2).sum(axis=1) * weight
    best: Exchange | None = None
    for i, j in combinations(range(len(V)), 2):
        swapped = u.copy()
        swapped[:, [i, j]] = u[:, [j, i]]
        moved = course.p + (reference.felt(swapped) - a) @ V @ course.white
        after = (moved**2).sum(axis=1) * weight
        won = np.cumsum((before - after)[::-1])[::-1][: 1 - SHORTEST]
        k = int(won.argmax())
        if won[k] > max(SURE, best.square if best else 0.0) and _alone(course, weight, before[k:], after[k:]):
            best = Exchange((i, j), float(course.blocks.first[k]) if k else 0.0, float(won[k]))
    return best


def _alone(course: ParityCourse, weight: Array, before: Array, after: Array) -> bool:
    """Whether nothing else is as good in the last blocks: not the readings as they are, and not a course of one sensor,
    which has a free number for every block.
    """
    if after.sum() > LEFT * before.sum():
        return False
    units = course.directions / np.linalg.norm(course.directions, axis=1, keepdims=True)
    last = slice(len(weight) - len(before), None)
    across = before.sum() - (weight[last, None] * (course.p[last] @ units.T) ** 2).sum(axis=0)
    return bool(after.sum() < max(LEFT * across.min(), LEFT**2 * before.sum()))


@dataclass(frozen=True, eq=False)
class Sign:
    """A course that steps, of one sensor, by number."""

    sensor: int
    shape: FaultShape
    z: float
    size: float
    """m/s² (rad/s), one sigma of a sample."""
    sigma: float
    noisier: Array
    """(T,) variance that it adds to a block's mean, whitened."""
    follows: bool = False
    """Whether the noise occurs only as far as the others move."""


def growth_of(course: ParityCourse) -> Sign | None:
    """The sensor whose noise grows most surely; None where none does by `GROWN`."""
    best: Sign | None = None
    b, visible = course.blocks, course.reference.visible
    for i in range(b.flutter.shape[1]):
        power = b.flutter[:, i] / max(visible[i], np.finfo(float).tiny)
        explained = _explained(power, b.change[:, i])
        scan = _steps(np.log(np.maximum(power, 1e-6 * explained + np.finfo(float).tiny) / explained))
        shape = best_onset(course, scan, NOISE, None)
        size, sigma = scan.size(shape.shape)
        z = float(np.sqrt(shape.square))
        on = shape.shape > 0
        w, beta = _fit(power[~on], b.change[~on, i]) if (~on).sum() >= FEW else (float(explained.min()), 0.0)
        added = float(np.median(power[on] - w - beta * b.change[on, i]))
        if size < np.log(GROWN) or on.sum() < FEW or added <= 0 or (best is not None and added <= best.size):
            continue
        noisier = shape.shape * added / visible[i] * course.along(i)[2] ** 2 / b.samples
        alone, beside = np.log(power[on]), np.log(power[on] / b.change[on, i])
        best = Sign(i, shape, z, added, sigma, noisier, bool(beside.std() < FOLLOWS * alone.std()))
    if best is None:
        return None
    grown = float(np.sqrt(best.size / visible[best.sensor]))
    return Sign(best.sensor, best.shape, best.z, grown, 0.5 * grown * best.sigma, best.noisier, best.follows)


def _explained(power: Array, change: Array) -> Array:
    """(T,) power (T,) as a constant and a share of the change (T,), each by its own relative error."""
    w, beta = _fit(power, change)
    return np.asarray(w + beta * change + 1e-9 * np.median(power) + np.finfo(float).tiny)


def _fit(power: Array, change: Array) -> tuple[float, float]:
    """The constant and the share."""
    fitted = np.full(len(power), float(np.median(power)) + np.finfo(float).tiny)
    w, beta = 0.0, 0.0
    for _ in range(3):
        weight = 1.0 / np.maximum(fitted, power)
        w, beta = nnls(np.column_stack([weight, change * weight]), power * weight)[0]
        fitted = w + beta * change + 1e-9 * fitted
    return float(w), float(beta)


def _steps(x: Array) -> Scan:
    """A course (T,) of any unit with noise as its neighbours differ; its level is free."""
    fixed = FREE**2 * np.ones((len(x), len(x)))
    variance = _roughness(x)
    return scan_of(x, variance, colour_of(x[:, None], variance, fixed, 0.5, wandering=True), fixed)


def _roughness(x: Array) -> Array:
    """(T,) variance from the difference of each point from its neighbours' mean, smoothed."""
    square = np.convolve(x, [-0.5, 1.0, -0.5], mode="same")[1:-1] ** 2 / 1.5
    square = np.pad(square, 1, mode="edge")
    local = median_filter(square, size=min(NEAR, len(x)), mode="nearest") / chdtri(1, 0.5)
    return np.asarray(np.maximum(local, 0.3 * np.median(square) / chdtri(1, 0.5)) + np.finfo(float).tiny)
