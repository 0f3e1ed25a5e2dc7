"""Simulated deviations through time with known truth, in tolerances and years."""

import numpy as np

from estimator.health.trend import Series
from estimator.session import Array

SIGMA = 0.1


def dates(rng: np.random.Generator, sessions: int, years: float = 3.0) -> Array:
    """Irregular dates from 0 on."""
    return np.sort(np.concatenate([[0.0], rng.uniform(0, years, sessions - 1)]))


def walk(rng: np.random.Generator, time: Array, strength: float) -> Array:
    """A random walk from 0; strength in T a root year."""
    steps = rng.standard_normal(len(time) - 1) * np.sqrt(np.diff(time))
    return strength * np.concatenate([[0.0], np.cumsum(steps)])


def measured(rng: np.random.Generator, time: Array, truth: Array, sigma: float = SIGMA) -> Series:
    """Sessions of a true deviation; the first is the reference, recorded as 0."""
    value = truth - truth[0] + sigma * rng.standard_normal(len(time))
    return Series(time, value - value[0], np.full(len(time), sigma), 1.0)
