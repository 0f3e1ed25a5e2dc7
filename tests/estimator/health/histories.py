"""Simulated deviations through time with known truth, in tolerances and years."""

import numpy as np

from estimator.health.fits import Readings
from estimator.health.prognosis import Track
from estimator.session import Array

SIGMA = 0.1


def dates(rng: np.random.Generator, sessions: int, years: float = 3.0) -> Array:
    """Irregular dates from 0 on."""
    return np.sort(np.concatenate([[0.0], rng.uniform(0, years, sessions - 1)]))


def walk(rng: np.random.Generator, time: Array, strength: float) -> Array:
    """A random walk from 0; strength in T a root year."""
    steps = rng.standard_normal(len(time) - 1) * np.sqrt(np.diff(time))
    return strength * np.concatenate([[0.0], np.cumsum(steps)])


def measured(rng: np.random.Generator, time: Array, truth: Array, sigma: float = SIGMA) -> Track:
    """Sessions of a true deviation (n,) or (n, 2); the first is the reference, recorded as 0."""
    truth = truth.reshape(len(time), -1)
    value = truth - truth[0] + sigma * rng.standard_normal(truth.shape)
    return Track(time, value - value[0], np.full(truth.shape, sigma), 1.0)


def readings(track: Track) -> Readings:
    """The readings of a track, with nothing in the base but the level."""
    n = len(track.time)
    return Readings(track.time, track.change, track.sigma, np.ones((n, 1)), np.ones(1))
