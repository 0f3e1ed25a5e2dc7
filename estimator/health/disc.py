"""The chance that a two-dimensional normal vector falls inside a disc, and limits for the length behind a measured one.

With equal variances s² the length squared over s² of N(c, s²I) is noncentral chi-square with two degrees of freedom and
noncentrality |c|²/s². With unequal variances it is a weighted sum of two; the integral over the disc is then taken
exactly along one principal axis (normal distribution function) and by Gauss–Legendre quadrature along the other.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq
from scipy.special import ndtr, ndtri

from estimator.arrays import eigh
from estimator.coverage import chance
from estimator.coverage import coverage_factor as student
from estimator.session import Array

NODES, WEIGHTS = np.polynomial.legendre.leggauss(160)
"""(160,) dimensionless; so many that the probability is right to 1e-10 for a sigma of a twentieth of the disc."""
CENTRE = 1e-3
"""Standard deviations within which a limit counts as beside the measured length, where the ratio below is 0/0."""
REACH = 9.0
"""Standard deviations beyond which a normal density is left out (1e-18)."""


def disc_probability(center: Array, sigma: Array, radius: float) -> float:
    """P(|x| ≤ radius) for x ~ N(center, diag(sigma²)).

    Parameters
    ----------
    center : (2,) mean, unit of the radius.
    sigma : (2,) standard deviations along the same axes, same unit, 0 where known exactly; the smaller one first
        resolves best.
    radius : radius of the disc around the origin.

    Notes
    -----
    x₁ = r·sin t turns the square-root ends of the chord h = r·cos t into smooth ones.
    """
    chord, weight = _chords(center[0], sigma[0], radius)
    return _share(chord, weight, center[1], sigma[1])


def _chords(center: float, sigma: float, radius: float) -> tuple[Array, Array]:
    """Half chords (160,) of the disc across the first axis, unit of the radius; their probability weights (160,)."""
    if radius <= 0:
        return np.zeros(1), np.zeros(1)
    if sigma == 0:
        return np.sqrt([max(radius**2 - center**2, 0.0)]), np.array([float(abs(center) <= radius)])
    reach = (np.array([-REACH, REACH]) * sigma + center) / radius
    start, end = np.arcsin(np.minimum(np.maximum(reach, -1), 1))
    t = (end - start) / 2 * NODES + (end + start) / 2
    chord = radius * np.cos(t)
    density = np.exp(-(((radius * np.sin(t) - center) / sigma) ** 2) / 2) / (np.sqrt(2 * np.pi) * sigma)
    return chord, (end - start) / 2 * WEIGHTS * density * chord


def _share(chord: Array, weight: Array, center: float, sigma: float) -> float:
    """Probability of the disc: weights (n,) times the probability of each half chord (n,) along the second axis."""
    if sigma == 0:
        inside = (np.abs(center) <= chord).astype(float)
    else:
        inside = ndtr((chord - center) / sigma) - ndtr((-chord - center) / sigma)
    return min(max(float(np.sum(weight * inside)), 0.0), 1.0)


def beyond_discs(centers: Array, sigmas: Array, radius: float) -> Array:
    """P(|x| > radius) for each of n normal vectors: the risk of an axis whose tolerance is a disc.

    Parameters
    ----------
    centers, sigmas : (n, 2) means and standard deviations along the same axes, unit of the radius; 0 where known
        exactly.
    radius : radius of the disc around the origin.

    Returns
    -------
    (n,) probability.
    """
    inside = [disc_probability(c[s.argsort()], np.sort(s), radius) for c, s in zip(centers, sigmas, strict=True)]
    return 1.0 - np.array(inside)


@dataclass(frozen=True)
class Length:
    """Estimate of the length of a true vector from a measured one."""

    value: float
    """Median-unbiased: a true length of this would be measured longer as often as shorter; 0 if noise explains all."""
    expanded: float
    """U: the true length is at most value + U, and at least value − U, each at the one-sided level of the factor."""
    probability_beyond: float
    """Chance that the true length exceeds the limit, the measured vector being what is known of it."""


def judge_length(
    vector: Array, covariance: Array, limit: float, coverage_factor: float, dof: float | None = None
) -> Length:
    """Length of a two-dimensional deviation, freed of the upward pull of noise.

    Parameters
    ----------
    vector : (2,) measured deviation, any unit (of an axis rad).
    covariance : (2, 2) its covariance, positive semidefinite, unit of the vector squared.
    limit : the tolerance that the length is compared with, unit of the vector.
    coverage_factor : k for known noise; the one-sided level of the limits is Φ(k).
    dof : degrees of freedom of the covariance; None when the noise is known.

    Notes
    -----
    A true length δ along the axis of largest variance is rejected as too long when P(|x| ≤ |d|; δ) < Φ(−k), as too
    short when it exceeds Φ(k). That axis is the least favourable direction, so the levels hold for every direction.
    U is never below k times the largest standard deviation. Of few degrees of freedom the limits are those of standard
    deviations enlarged by t/k, and the chance is that of deviations with which the nearest edge is as likely as by t.
    """
    variances, axes = eigh(covariance)
    sigma = np.sqrt(np.maximum(variances, 0.0))
    measured = float(np.hypot(*vector))
    if sigma[1] == 0:
        return Length(measured, 0.0, float(measured > limit))
    factor = student(coverage_factor, dof)
    wide = sigma * (factor / coverage_factor)
    upper, lower = (_length_with(p, measured, wide) for p in ndtr([-coverage_factor, coverage_factor]))
    value = _length_with(0.5, measured, sigma)
    expanded = max(factor * float(sigma[1]), upper - value, value - lower)
    wider = _wider((limit - measured) / float(sigma[1]), dof)
    beyond = float(beyond_discs((axes.T @ vector)[None], (sigma * wider)[None], limit)[0])
    return Length(value, expanded, min(1.0, max(0.0, beyond)))


def _wider(distance: float, dof: float | None) -> float:
    """Factor on standard deviations that gives a normal law the chance that Student's gives beyond a ``distance``.

    distance : of the limit from the measured length, in standard deviations; below zero where it is exceeded.
    """
    if dof is None:
        return 1.0
    away = max(abs(distance), CENTRE)
    return away / -float(ndtri(chance(-away, dof)))


def _length_with(probability: float, measured: float, sigma: Array) -> float:
    """The true length along the axis of largest variance for which P(|x| ≤ measured) is the probability; 0 if none is.

    sigma : (2,) standard deviations, rising, unit of the length.
    """
    chord, weight = _chords(0.0, sigma[0], measured)

    def excess(length: float) -> float:
        return _share(chord, weight, length, sigma[1]) - probability

    if excess(0.0) <= 0:
        return 0.0
    reach = measured + REACH * float(sigma[1])
    return float(brentq(excess, 0.0, reach, xtol=1e-5 * float(sigma[1])))
