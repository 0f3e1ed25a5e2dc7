"""Stated dates of somebody who knows the second generator: every kind, their shares, all laws of sizes and of errors.

What a kind may have done is drawn from its own law given the readings. Times and constants are drawn from their prior;
size a and error e₀ of the reference, of which deviations a·(f(t) − f(0)) − e₀ are linear, from Student's law about
their weighted least squares; the weight is prior times likelihood over the density drawn from. One that wanders is
followed by particles (Gordon, Salmond & Smith 1993). Of dates that hold as often as they claim whatever the readings
are, none is later but by chance.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import stats

from benchmarks.backtest import workshop as law
from benchmarks.backtest.histories import STEP, YEARS, History
from estimator.session import Array

DRAWS, FOLLOWED = 4000, 2000
"""Of each kind, and of all together those that are followed into the future: a chance of 10 % to within 1 %."""
WIDE, TAILS = 1.5, 5.0
"""Of the law that sizes are drawn from: wider than the least squares say, with heavy tails."""
MEDIANS = {"shock": 0.5, "shock and back": 0.5, "creep": 0.3, "late creep": 0.3, "settling": 0.7}
"""Of the log-normal sizes, T or T a year."""
Course = Callable[[Array], Array]
"""(N, t) courses of N draws per unit of size, at times (t,), years."""


@dataclass(frozen=True, eq=False)
class Kind:
    """Draws of one kind."""

    log_weight: Array
    """(N,) prior times likelihood over the density that was drawn from; their mean is the kind's evidence."""
    future: Callable[[Array], Array]
    """Of places (m,), the deviations (m, t) at all dates from the last session on, T."""


def early(one: History, since: int, level: float, rng: np.random.Generator) -> float:
    """Years from the last session before which the tolerance is passed with a chance, what changes one day having done
    so ``since`` sessions back or more; infinite if never."""
    days = STEP * np.arange(round(float(one.time[-1]) / STEP), round(YEARS / STEP))
    kinds = [drawn(kind, one, (since, days), rng) for kind in law.DESCRIBED]
    weight = np.exp(np.stack([kind.log_weight for kind in kinds]) - max(kind.log_weight.max() for kind in kinds))
    rough = np.cumsum(weight) / weight.sum()
    picked = np.searchsorted(rough, (np.arange(FOLLOWED) + rng.uniform()) / FOLLOWED)
    found = [_passed(kind.future(picked[picked // DRAWS == i] % DRAWS)) for i, kind in enumerate(kinds)]
    passed = np.concatenate(found)
    inside = passed[passed > 0]
    return float(np.quantile(inside, level, method="inverted_cdf")) if len(inside) else float("inf")


def _passed(deviation: Array) -> Array:
    """(m,) years until deviations (m, t) are out of tolerance; infinite if never."""
    beyond = np.abs(deviation) >= 1
    return np.where(beyond.any(axis=1), STEP * beyond.argmax(axis=1), np.inf)


def drawn(kind: str, one: History, of: tuple[int, Array], rng: np.random.Generator) -> Kind:
    """Of a kind; ``of`` sessions since a change, at least, and the days (t,) of the future, years."""
    since, days = of
    if kind == "small shocks":
        return _wandering(one, days, rng)
    if kind == "unheated":
        return _weathered(one, days, rng)
    if kind not in MEDIANS:
        return _unsized(one, np.zeros((DRAWS, len(one.time))), lambda own: np.zeros((len(own), len(days))), rng)
    return _sized(one, _course(kind, one, since, rng), MEDIANS[kind], days, rng)


def _course(kind: str, one: History, since: int, rng: np.random.Generator) -> Course:
    """Courses with times and constants from their prior."""
    latest = float(one.time[-1 - since]) if since else YEARS
    whole = -np.expm1(-latest / law.HAZARD)
    onset = -law.HAZARD * np.log1p(-rng.uniform(size=(DRAWS, 1)) * whole)
    back, constant = onset + rng.uniform(0.2, 2.0, (DRAWS, 1)), rng.uniform(0.1, 2.0, (DRAWS, 1))
    courses: dict[str, Course] = {
        "shock": lambda t: (t >= onset).astype(float),
        "shock and back": lambda t: ((t >= onset) & (t < back)).astype(float),
        "creep": lambda t: np.tile(t, (DRAWS, 1)),
        "late creep": lambda t: _bent(np.maximum(t - onset, 0.0)),
        "settling": lambda t: t / (t + constant),
    }
    return courses[kind]


def _bent(late: Array) -> Array:
    """A drift that takes up its rate, years; the same shape as ``late``, years."""
    return np.where(late < law.BEND, late**2 / (2 * law.BEND), late - law.BEND / 2)


def _sized(one: History, course: Course, median: float, days: Array, rng: np.random.Generator) -> Kind:
    """Sizes and e₀ of courses."""
    shape = course(one.time)
    weight, sign = one.sigma**-2.0, np.append(1.0, np.full(len(one.time) - 1, -1.0))
    cross = (weight * sign * shape).sum(axis=1)
    normal = np.stack([(weight * shape**2).sum(axis=1) + median**-2.0, cross, cross, np.full(DRAWS, weight.sum())])
    covariance = np.linalg.inv(normal.T.reshape(-1, 2, 2))
    pull = np.stack([shape @ (weight * one.value), np.full(DRAWS, (weight * sign) @ one.value)], axis=1)
    root = WIDE * np.linalg.cholesky(covariance)
    steps = rng.standard_t(TAILS, (DRAWS, 2))
    found = np.einsum("nij,nj->ni", covariance, pull) + np.einsum("nij,nj->ni", root, steps)
    density = stats.t.logpdf(steps, TAILS).sum(axis=1) - np.log(np.diagonal(root, axis1=1, axis2=2)).sum(axis=1)
    size, origin = found.T
    prior = stats.lognorm.logpdf(np.abs(size), 0.5, scale=median) - np.log(2)
    log = prior + _log_likelihood(one, size[:, None] * shape, origin) - density
    return Kind(log, lambda own: size[own, None] * course(days)[own] - origin[own, None])


def _unsized(one: History, moved: Array, ahead: Callable[[Array], Array], rng: np.random.Generator) -> Kind:
    """e₀ of what moved by (N, n) since the reference; ``ahead`` that in future."""
    weight, sign = one.sigma**-2.0, np.append(1.0, np.full(len(one.time) - 1, -1.0))
    scale = WIDE * weight.sum() ** -0.5
    steps = rng.standard_t(TAILS, DRAWS)
    origin = (one.value - moved) @ (weight * sign) / weight.sum() + scale * steps
    log = _log_likelihood(one, moved, origin) - stats.t.logpdf(steps, TAILS) + np.log(scale)
    return Kind(log, lambda own: ahead(own) - origin[own, None])


def _log_likelihood(one: History, moved: Array, origin: Array) -> Array:
    """(N,) of what moved by (N, n) since the reference, whose error is ``origin`` (N,), T."""
    later = one.value[1:] - moved[:, 1:] + origin[:, None]
    return np.asarray(_log_errors(np.column_stack([origin, later]), one.sigma).sum(axis=1))


def _log_errors(errors: Array, sigma: Array) -> Array:
    """Log density of errors (N, n), T, of sigmas (n,)."""
    scale = sigma * np.sqrt((law.TAILS - 2) / law.TAILS)
    return np.asarray(stats.t.logpdf(errors / scale, law.TAILS) - np.log(scale))


def _weathered(one: History, days: Array, rng: np.random.Generator) -> Kind:
    """One that follows the weather, which was measured to 0.3 °C; that of the future is of any year."""
    felt = one.temperature - 20 - 0.3 * rng.standard_normal((DRAWS, len(one.time)))
    slope = rng.choice([-1.0, 1.0], DRAWS) * rng.uniform(0.02, 0.06, DRAWS)

    def ahead(own: Array) -> Array:
        come = np.array([law.weather(days, rng) for _ in own]).reshape(len(own), len(days))
        come[:, 0] = felt[own, -1]
        return np.asarray(slope[own, None] * (come - felt[own, :1]))

    return _unsized(one, slope[:, None] * (felt - felt[:, :1]), ahead, rng)


def _wandering(one: History, days: Array, rng: np.random.Generator) -> Kind:
    """Many small shocks, session after session."""
    each = rng.uniform(0.1, 0.4, DRAWS) / np.sqrt(2 * law.SHOCKS)
    value = -one.sigma[0] * np.sqrt((law.TAILS - 2) / law.TAILS) * rng.standard_t(law.TAILS, DRAWS)
    log = 0.0
    for i, steps in enumerate(np.round(np.diff(one.time) / STEP).astype(int), start=1):
        value = value + _shocks(each, steps, rng)
        weight = np.exp(_log_errors((one.value[i] - value)[:, None], one.sigma[i : i + 1])[:, 0])
        log += float(np.log(max(weight.mean(), 1e-300)))
        kept = np.searchsorted(np.cumsum(weight) / weight.sum(), (np.arange(DRAWS) + rng.uniform()) / DRAWS)
        value, each = value[np.minimum(kept, DRAWS - 1)], each[np.minimum(kept, DRAWS - 1)]

    def ahead(own: Array) -> Array:
        come = rng.uniform(size=(len(own), len(days))) < law.SHOCKS * STEP
        come[:, 0] = False
        return np.asarray(value[own, None] + np.cumsum(rng.laplace(0.0, each[own, None], come.shape) * come, axis=1))

    return Kind(np.full(DRAWS, log), ahead)


def _shocks(each: Array, steps: int, rng: np.random.Generator) -> Array:
    """(N,) sums of Laplace's shocks within so many steps, of scales (N,), T: normal ones of gamma variance."""
    count = rng.binomial(steps, law.SHOCKS * STEP, len(each))
    return np.asarray(each * np.sqrt(2 * rng.gamma(np.maximum(count, 1e-12))) * rng.standard_normal(len(each)))
