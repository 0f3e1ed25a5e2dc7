"""Blocks of which one axis drifted by a part of its tolerance while the block sits otherwise: does U hold the drift?"""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from benchmarks.study.rates import Rate, rate
from estimator.health.changes import AxisPairs
from estimator.health.common_motion import split_axes
from estimator.health.disc import judge_length

ARCSEC = np.pi / 180 / 3600
TOLERANCE = 20 * ARCSEC
REACH = (0.2, 0.6)
"""Range of the drift, parts of the tolerance."""
FACTOR = 2.0
"""k."""
Vectors = NDArray[np.float64]


def held(m: int, sigma: float, blocks: int, seed: int) -> tuple[Rate, Rate]:
    """Rates at which U holds the drifted axis' change, and the zero change of each of the others; sigma of a session,
    rad.
    """
    rng, own, others = np.random.default_rng([seed, m]), list[bool](), list[bool]()
    for _ in range(blocks):
        marks = _block(m, sigma, rng)
        own.append(marks[0])
        others += marks[1:]
    return rate(own), rate(others)


def _block(m: int, sigma: float, rng: np.random.Generator) -> list[bool]:
    """Whether U holds the change of each axis, the drifted one first."""
    axes = _cone(m)
    size, frames = rng.uniform(*REACH) * TOLERANCE, np.stack([_across(axis) for axis in axes])
    drifted, angle = axes.copy(), rng.uniform(0, 2 * np.pi)
    about = frames[0] @ np.array([np.cos(angle), np.sin(angle)])
    drifted[0] = Rotation.from_rotvec(size * about).apply(axes[0])
    sits = Rotation.from_rotvec(10 * ARCSEC * rng.standard_normal(3))
    now, then = _seen(sits.apply(drifted), sigma, rng), _seen(axes, sigma, rng)
    covariance = sigma**2 * np.eye(2 * m)
    names, known = tuple(f"A{i}" for i in range(m)), ((None, None),) * m
    pairs = AxisPairs(
        names, now, np.stack([_across(a) for a in now]), then, np.stack([_across(a) for a in then]),
        covariance, covariance, known,
    )  # fmt: skip
    found = split_axes("accelerometer", pairs, TOLERANCE, is_seen=True).residuals
    true = [size, *[0.0] * (m - 1)]
    return [_holds(found[name].vector, found[name].covariance, t) for name, t in zip(names, true, strict=True)]


def _holds(vector: Vectors, covariance: Vectors, true: float) -> bool:
    length = judge_length(vector, covariance, TOLERANCE, FACTOR)
    return abs(length.value - true) <= length.expanded


def _cone(m: int) -> Vectors:
    """(m, 3) axes about Z on a cone that is as wide as a cube's corner, and every fourth along Z."""
    turns = 2 * np.pi * np.arange(m) / m
    tilt = np.where(np.arange(m) % 4 == 3, 0.0, np.arccos(1 / np.sqrt(3)))
    return np.stack([np.sin(tilt) * np.cos(turns), np.sin(tilt) * np.sin(turns), np.cos(tilt)], axis=1)


def _across(axis: Vectors) -> Vectors:
    """(3, 2) two unit vectors across an axis."""
    first = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(axis, first)], axis=1)


def _seen(axes: Vectors, sigma: float, rng: np.random.Generator) -> Vectors:
    """(m, 3) each axis turned by an error of its own."""
    turned: Vectors = Rotation.from_rotvec(sigma * rng.standard_normal(axes.shape)).apply(axes)
    return turned
