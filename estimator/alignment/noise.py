"""Noise of a strapdown system at rest, from its own readings: density of the white noise, and sway of the base.

The means s of equal steps of a reading at rest scatter by white noise of density q and, for accelerometers, by the
base's sway, a velocity of variance σ² that is new at every step: s_k = white + (v_k − v_{k−1})/Δ. Then

    var s = q/Δ + 2σ²/Δ²,   cov(s_k, s_{k+1}) = −σ²/Δ²

so that σ² = −Δ²·cov and q = Δ·(var + 2 cov), the density at low frequency, which is what angles and velocities grow by.
"""

from dataclasses import dataclass

import numpy as np

from estimator.arrays import eigh
from estimator.session import Array

LEAST = 0.1
"""Part of the scatter that is taken for white noise at least: the difference of two estimates from few steps may stray
to zero and below."""
SIGNIFICANT = 2.0
"""Standard deviations of chance from which neighbouring steps count as related: wrongly for 2 % of still tables, where
it then changes little."""
TINY = 1e-7
"""m/s; a computed velocity is taken for exact to this: what white noise of `LEAST_DENSITY` adds in a second."""
LEAST_DENSITY = {"accelerometer": 1e-7, "gyro": 1e-10}
"""m/s²/√Hz, rad/s/√Hz: noise that the filter reckons with at least, far below that of any instrument, so that sessions
without noise do not strain its arithmetic."""


@dataclass(frozen=True, eq=False)
class FilterNoise:
    """Densities of white noise along the block's axes, and the sway of the base."""

    accelerometer: Array
    """(3, 3), (m/s²)²/Hz."""
    gyro: Array
    """(3, 3), (rad/s)²/Hz."""
    velocity: float
    """One sigma of the base's velocity per axis, new at every step, m/s."""
    stated: bool
    """Whether the file states it, rather than the readings."""


def at_rest(means: list[Array], step: float) -> tuple[Array, float]:
    """Density (3, 3), (m/s²)²/Hz or (rad/s)²/Hz, and variance of the integral that is new at each step, (m/s)² or rad².

    Parameters
    ----------
    means : the step means (k, 3) of every stop, m/s² or rad/s.
    step : s.
    """
    rest = [_level(stop) for stop in means if len(stop) > 3]
    freedom = sum(len(stop) - 2 for stop in rest)
    variance = sum((stop.T @ stop for stop in rest), np.zeros((3, 3))) / freedom
    products = sum((_lagged(stop) for stop in rest), np.zeros((3, 3))) / freedom
    related = np.trace(products) < -SIGNIFICANT * np.sqrt(np.trace(variance @ variance) / freedom)
    if not related:
        return step * variance, 0.0
    values, vectors = eigh(variance)
    white = np.clip(np.einsum("ij,ik,kj->j", vectors, variance + 2 * products, vectors), LEAST * values, values)
    return step * (vectors * white) @ vectors.T, step**2 * max(-float(np.trace(products[:2, :2])) / 2, 0.0)


def _level(stop: Array) -> Array:
    """The means (k, 3) of a stop without their mean and trend, in their unit."""
    time = np.linspace(-1.0, 1.0, len(stop))[:, None]
    centred = stop - stop.mean(axis=0)
    return centred - time * (time * centred).sum(axis=0) / (time * time).sum()


def _lagged(stop: Array) -> Array:
    """Symmetric sum (3, 3) of products of neighbours among means (k, 3), their unit squared."""
    products = stop[:-1].T @ stop[1:]
    return 0.5 * (products + products.T)
