"""Courses of parameters over the years, in tolerances, one value a day.

Sizes and times come from beta, gamma, Weibull and triangular laws, each bounded away from absurd values.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
YEAR = 365.25
HORIZON = 20.0
"""Years that a course goes on."""
DAYS = np.arange(round(HORIZON * YEAR))
STABLE, WALK, RAMP, STEP, AGING, SEASONAL = "stable", "walk", "ramp", "step", "aging", "seasonal"
KINDS = {
    STABLE: "nothing moves",
    WALK: "Gaussian walk, beta law from 0.05 to 0.5 T a root year",
    RAMP: "gamma law about 0.4 T a year, from some day of its first six years on, in one of three from the first",
    STEP: "triangular law from 0.2 to 1.6 T, once, at a Weibull time",
    AGING: "part of it gone before the reference: exponential or logarithmic, gamma law about 0.9 T in ten years",
    SEASONAL: "0.01 to 0.08 T per °C, some with a curvature, in halls that are cold in winter",
}
Random = np.random.Generator


def course(kind: str, rng: Random) -> Array:
    """(days,) T, of one parameter; of a seasonal one nothing but the temperature moves it."""
    return COURSES[kind](rng)


def _still(rng: Random) -> Array:
    del rng
    return np.zeros(len(DAYS))


def _sign(rng: Random) -> float:
    return 1.0 if rng.random() < 0.5 else -1.0


def _walk(rng: Random) -> Array:
    strength = 0.05 + 0.45 * rng.beta(2.0, 3.0)
    return np.cumsum(rng.standard_normal(len(DAYS))) * strength / np.sqrt(YEAR)


def _ramp(rng: Random) -> Array:
    rate = 0.05 + rng.gamma(3.0, 0.35 / 3)
    onset = 0.0 if rng.random() < 1 / 3 else 6 * rng.beta(1.2, 1.2)
    return _sign(rng) * rate * np.maximum(DAYS / YEAR - onset, 0.0)


def _step(rng: Random) -> Array:
    at = 2.5 * rng.weibull(1.3)
    return np.asarray(_sign(rng) * rng.triangular(0.2, 0.5, 1.6) * (at <= DAYS / YEAR))


def _aging(rng: Random) -> Array:
    """Aging since its assembly some months before the reference."""
    before, constant = rng.gamma(2.0, 0.15), 0.1 + rng.gamma(2.0, 0.6)
    age = before + DAYS / YEAR
    gone = -np.expm1(-age / constant) if rng.random() < 0.5 else np.log1p(age / constant) / np.log1p(10 / constant)
    return _sign(rng) * (0.2 + rng.gamma(3.0, 0.7 / 3)) * gone


COURSES: dict[str, Callable[[Random], Array]] = {
    STABLE: _still,
    WALK: _walk,
    RAMP: _ramp,
    STEP: _step,
    AGING: _aging,
    SEASONAL: _still,
}


def temperature_law(kind: str, rng: Random) -> tuple[float, float]:
    """T per °C and T per °C²; zero of all that are not seasonal."""
    if kind != SEASONAL:
        return 0.0, 0.0
    slope = _sign(rng) * rng.uniform(0.01, 0.08)
    return slope, slope * rng.normal(0.0, 0.02) if rng.random() < 0.3 else 0.0
