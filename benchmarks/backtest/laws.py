"""The laws of both generators, as `knowing` asks for them."""

from collections.abc import Callable

import numpy as np
from scipy import stats

from benchmarks.backtest import histories, workshop
from benchmarks.backtest.histories import STEP, YEARS
from benchmarks.backtest.knowing import Course, Law, Random, Sized
from estimator.session import Array


def _uniform(low: float, high: float) -> Callable[[Array], Array]:
    """Log density of sizes of either sign."""
    return lambda size: np.where((np.abs(size) >= low) & (np.abs(size) <= high), -np.log(2 * (high - low)), -np.inf)


def _log_normal(median: float) -> Callable[[Array], Array]:
    """Log density of log-normal sizes of either sign, of the second generator."""
    return lambda size: np.asarray(stats.lognorm.logpdf(np.abs(size), 0.5, scale=median) - np.log(2))


def _steps(onset: Array) -> Course:
    return lambda t: (t >= onset).astype(float)


def _early_onset(count: int, rng: Random) -> Array:
    """(count, 1) years, of the first generator."""
    return rng.uniform(0, YEARS / 2, (count, 1))


def _hazard(count: int, rng: Random) -> Array:
    """(count, 1) years, of the second."""
    return -workshop.HAZARD * np.log1p(rng.uniform(size=(count, 1)) * np.expm1(-YEARS / workshop.HAZARD))


def _late(count: int, rng: Random) -> Course:
    onset = _early_onset(count, rng)
    return lambda t: np.maximum(t - onset, 0.0)


def _aging(count: int, rng: Random) -> Course:
    constant = rng.uniform(0.3, 1.5, (count, 1))
    return lambda t: -np.expm1(-t / constant)


def _linear(count: int, rng: Random) -> Course:
    return lambda t: np.tile(t, (count, 1))


def _bent(count: int, rng: Random) -> Course:
    onset, bend = _hazard(count, rng), workshop.BEND

    def course(t: Array) -> Array:
        late = np.maximum(t - onset, 0.0)
        return np.where(late < bend, late**2 / (2 * bend), late - bend / 2)

    return course


def _there_and_back(count: int, rng: Random) -> Course:
    onset = _hazard(count, rng)
    back = onset + rng.uniform(0.2, 2.0, (count, 1))
    return lambda t: ((t >= onset) & (t < back)).astype(float)


def _settling(count: int, rng: Random) -> Course:
    constant = rng.uniform(0.1, 2.0, (count, 1))
    return lambda t: t / (t + constant)


def _walk(scale: Array, steps: int, rng: Random) -> Array:
    return np.asarray(scale * np.sqrt(steps * STEP) * rng.standard_normal(scale.shape))


def _shocks(scale: Array, steps: int, rng: Random) -> Array:
    """Sums of Laplace's shocks: normal ones of gamma variance."""
    count = rng.binomial(steps, workshop.SHOCKS * STEP, scale.shape)
    spread = np.sqrt(rng.gamma(np.maximum(count, 1e-12)) / workshop.SHOCKS)
    return np.asarray(scale * spread * rng.standard_normal(scale.shape))


def _seasons(days: Array, rng: Random) -> Array:
    return np.asarray(rng.uniform(3, 6) * np.sin(2 * np.pi * (days + rng.uniform())))


HEAVY = np.sqrt((workshop.TAILS - 2) / workshop.TAILS)
"""Scale of the second generator's errors."""
FIRST_LAW = Law(
    kinds=tuple(histories.DESCRIBED),
    sized={
        "step": Sized(0.8, _uniform(0.4, 1.2), lambda count, rng: _steps(_early_onset(count, rng))),
        "ramp": Sized(0.5, _uniform(0.2, 0.8), _linear),
        "late ramp": Sized(0.5, _uniform(0.2, 0.8), _late),
        "aging": Sized(0.8, _uniform(0.5, 1.2), _aging),
    },
    log_error=lambda z: np.asarray(stats.norm.logpdf(z)),
    errors=lambda count, rng: rng.standard_normal(count),
    wanders="walk",
    scales=(0.1, 0.4),
    steps=_walk,
    seasonal="seasonal",
    slopes=(0.02, 0.06),
    thermometer=(21.0, 0.5),
    air=_seasons,
)
SECOND_LAW = Law(
    kinds=tuple(workshop.DESCRIBED),
    sized={
        "shock": Sized(0.5, _log_normal(0.5), lambda count, rng: _steps(_hazard(count, rng))),
        "shock and back": Sized(0.5, _log_normal(0.5), _there_and_back),
        "creep": Sized(0.3, _log_normal(0.3), _linear),
        "late creep": Sized(0.3, _log_normal(0.3), _bent),
        "settling": Sized(0.7, _log_normal(0.7), _settling),
    },
    log_error=lambda z: np.asarray(stats.t.logpdf(z / HEAVY, workshop.TAILS) - np.log(HEAVY)),
    errors=lambda count, rng: HEAVY * rng.standard_t(workshop.TAILS, count),
    wanders="small shocks",
    scales=(0.1, 0.4),
    steps=_shocks,
    seasonal="unheated",
    slopes=(0.02, 0.06),
    thermometer=(20.0, 0.3),
    air=workshop.weather,
)
