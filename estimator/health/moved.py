"""Finds the sensors that moved on their own: generalised least squares, likelihood ratios, rivals (`common_motion`).

Where the noise was estimated from ν degrees of freedom, χ²/r is Fisher's F of r and ν; limits are widened by as much.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from estimator.coverage import known_to
from estimator.health.changes import Changes
from estimator.session import Array
from estimator.significance import critical_chi2, single_level

LEVEL = 0.001
"""Chance that a sensor of a block without a single motion is left out: a tenth of the level of a session's verdict."""
RIVAL = 2 * np.log(100)
"""A rival explanation whose χ² is higher by less than this (likelihood a hundredth) is not ruled out."""
FEWEST_AGREEING = {1: 2, 2: 3}
"""Fewest sensors that must agree, by rows a sensor: two scales that kept their ratio, three axes their angles."""


@dataclass(frozen=True, eq=False)
class MotionFit:
    """Generalised least squares over some sensors."""

    gain: Array
    """(k, m r) x = gain·y, dimensionless."""
    weight: Array
    """(m r, m r) W, 1/rad² or 1/relative²."""
    chi2: float


def fit(changes: Changes, inside: list[int]) -> MotionFit:
    """Fits the common change to the sensors ``inside``; the others are free.

    C is widened by S = s²·A·Aᵀ, which changes neither x nor a residual, but keeps a covariance that is singular
    along A (a frame held by the axes themselves) from being inverted as it is.
    """
    at, n = changes.where(inside), len(changes.y)
    g, w = _solved(changes.design[at], changes.covariance[np.ix_(at, at)])
    gain, weight = np.zeros((g.shape[0], n)), np.zeros((n, n))
    gain[:, at], weight[np.ix_(at, at)] = g, w
    return MotionFit(gain, weight, float(changes.y @ weight @ changes.y))


@dataclass(frozen=True, eq=False)
class MotionFits:
    """Generalised least squares over each of s sets of sensors."""

    gain: Array
    """(s, k, m r) x = gain·y, dimensionless."""
    chi2: Array
    """(s,)"""


def fits(changes: Changes, sets: Sequence[Sequence[int]]) -> MotionFits:
    """`fit` for each of several sets; those of one size are solved as one stack."""
    chi2, gain = np.zeros(len(sets)), np.zeros((len(sets), changes.design.shape[1], len(changes.y)))
    covariance = changes.covariance
    for size in {len(members) for members in sets}:
        places = [i for i, members in enumerate(sets) if len(members) == size]
        at = changes.where([list(sets[i]) for i in places])
        g, w = _solved(changes.design[at], covariance[at[:, :, None], at[:, None, :]])
        y = changes.y[at]
        chi2[places] = np.einsum("sp,spq,sq->s", y, w, y)
        gain[np.array(places)[:, None], :, at] = np.swapaxes(g, -1, -2)
    return MotionFits(gain, chi2)


def _solved(a: Array, c: Array) -> tuple[Array, Array]:
    """Gain (..., k, p) and W (..., p, p) of designs (..., p, k) and covariances (..., p, p); see `fit`."""
    size, across = a.shape[-2], np.swapaxes(a, -1, -2)
    typical = np.maximum(np.trace(c, axis1=-2, axis2=-1) / size, 1e-18)[..., None, None]
    v = np.linalg.inv(c + typical * (a @ across) + 1e-12 * typical * np.eye(size))
    g = np.linalg.solve(across @ v @ a, across @ v)
    return g, v - v @ a @ g


def moved(changes: Changes) -> list[int] | None:
    """The sensors that moved on their own; None when that cannot be decided."""
    m, excluded = len(changes.names), list[int]()
    limit = chi2_limit(single_level(LEVEL, len(changes.names)), changes.rows, changes.dof)
    while is_majority(changes, excluded):
        inside = [i for i in range(m) if i not in excluded]
        fitted = fit(changes, inside)
        evidence = _evidence(changes, fitted, inside)
        if evidence.max() <= limit:
            suspects = excluded + _rivals(changes, excluded, fitted.chi2)
            return suspects if is_majority(changes, suspects) else None
        excluded = [*excluded, inside[int(np.argmax(evidence))]]
    return None


@cache
def chi2_limit(level: float, rows: int, dof: float | None) -> float:
    """χ² of so many rows that noise known to ``dof`` degrees of freedom exceeds with a probability."""
    return critical_chi2(level, rows, known_to(dof))


def is_majority(changes: Changes, excluded: list[int]) -> bool:
    """Whether the sensors that remain determine the common change: more than half, and enough to agree on it."""
    m = len(changes.names)
    return 2 * (m - len(excluded)) > m and m - len(excluded) >= FEWEST_AGREEING[changes.rows]


def _evidence(changes: Changes, fitted: MotionFit, inside: list[int]) -> Array:
    """(n,) χ²: twice what the log likelihood gains when each of n sensors is left out, dimensionless."""
    at = changes.where([[i] for i in inside])
    pull = (fitted.weight @ changes.y)[at][..., None]
    gained = np.swapaxes(pull, -1, -2) @ np.linalg.solve(fitted.weight[at[:, :, None], at[:, None, :]], pull)
    return np.asarray(gained[:, 0, 0])


def _rivals(changes: Changes, excluded: list[int], chi2: float) -> list[int]:
    """The sensors that could be left out instead of one of these and fit nearly as well."""
    inside = [i for i in range(len(changes.names)) if i not in excluded]
    near = RIVAL * chi2_limit(LEVEL, changes.rows, changes.dof) / chi2_limit(LEVEL, changes.rows, None)

    def fits(suspect: int, gone: int) -> bool:
        swapped = sorted([*(i for i in inside if i != suspect), gone])
        return fit(changes, swapped).chi2 - chi2 < near

    return [suspect for suspect in inside if any(fits(suspect, gone) for gone in excluded)]
