"""Noises made by other means than the estimator's: flicker by fractional differences (Kasdin 1995), others by sums."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def noise(n: int, interval: float, rng: np.random.Generator, **sizes: float) -> Array:
    """(n,) readings with white, flicker, walk and rounded of the stated sizes: N, B, K and Q."""
    y = sizes.get("white", 0.0) / np.sqrt(interval) * rng.standard_normal(n)
    y += sizes.get("flicker", 0.0) * flicker(n, rng)
    y += sizes.get("walk", 0.0) * np.sqrt(interval) * np.cumsum(rng.standard_normal(n))
    return y + sizes.get("rounded", 0.0) / interval * np.diff(rng.standard_normal(n + 1))


def flicker(n: int, rng: np.random.Generator) -> Array:
    """(n,) noise of one-sided spectrum 1/(πf): white noise through h_k = h_{k−1}·(k − ½)/k (Kasdin, Proc. IEEE 83,
    802).
    """
    k = np.arange(1, n)
    response = np.concatenate([[1.0], np.cumprod((k - 0.5) / k)])
    spectrum = np.fft.rfft(response, 2 * n) * np.fft.rfft(rng.standard_normal(n), 2 * n)
    return np.fft.irfft(spectrum, 2 * n)[:n]
