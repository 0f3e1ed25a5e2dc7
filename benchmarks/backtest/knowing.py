"""Stated dates of somebody who knows a generator: every kind, their shares, all laws of sizes, times and errors.

What a kind may have done is drawn from its own law given the readings. Times and constants are drawn from their prior;
size a and error e₀ of the reference, of which deviations a·(f(t) − f(0)) − e₀ are linear, from Student's law about
their weighted least squares; the weight is prior times likelihood over the density drawn from. One that wanders is
followed by particles (Gordon, Salmond & Smith 1993). So the date is as good as the readings allow, but for chance.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from scipy import stats

from benchmarks.backtest.histories import STEP, YEARS, History
from estimator.session import Array

DRAWS, FOLLOWED = 2000, 2000
"""Draws of each kind, and draws of all kinds that are followed into the future: a chance of 10 % to within 1 %."""
WIDE, TAILS = 1.5, 5.0
"""Widening of the law that sizes are drawn from, relative to least squares, and its degrees of freedom."""
Random = np.random.Generator
Course = Callable[[Array], Array]
"""(N, t) courses of N draws per unit of size, at times (t,), years."""


@dataclass(frozen=True)
class Sized:
    """A kind of one shape with one size."""

    typical: float
    """Size, T or T a year."""
    log_prior: Callable[[Array], Array]
    """Log density of sizes (N,) of either sign."""
    courses: Callable[[int, Random], Course]
    """Draws so many courses, with times and constants from their prior."""


@dataclass(frozen=True)
class Law:
    """All that a generator does; nothing moves in a kind that is named nowhere here."""

    kinds: tuple[str, ...]
    sized: Mapping[str, Sized]
    log_error: Callable[[Array], Array]
    """Log density of errors in standard deviations."""
    errors: Callable[[int, Random], Array]
    """Draws so many errors."""
    wanders: str
    scales: tuple[float, float]
    """Least and largest of what wanders, T a root year."""
    steps: Callable[[Array, int, Random], Array]
    """Draws the steps that such scales, in any shape, add within so many `STEP`."""
    seasonal: str
    slopes: tuple[float, float]
    """T per °C, of either sign."""
    thermometer: tuple[float, float]
    """°C: mean of the laboratory, standard deviation of a session's temperature."""
    air: Callable[[Array, Random], Array]
    """°C about the mean at days, years, of any year."""


@dataclass(frozen=True, eq=False)
class _Kind:
    """Draws of one kind."""

    log_weight: Array
    """(N,) prior times likelihood over the density that was drawn from; their mean is the kind's evidence."""
    future: Callable[[Array], Array]
    """The deviations (m, t), T, of the draws at places (m,), at all dates from the last session on."""


def early(one: History, law: Law, level: float, rng: Random) -> float:
    """Years from the last session before which the tolerance is passed with a chance; infinite if never."""
    return known_dates(one, law, (level,), rng)[0]


def known_dates(one: History, law: Law, levels: tuple[float, ...], rng: Random) -> tuple[float, ...]:
    """Dates for several chances, as `early`, given that the parameter is within its tolerance now."""
    inside = known_passages(one, law, rng)
    if not len(inside):
        return tuple(float("inf") for _ in levels)
    return tuple(float(q) for q in np.quantile(inside, levels, method="inverted_cdf"))


def known_passages(one: History, law: Law, rng: Random) -> Array:
    """(m,) years, all as likely, after which it passes its tolerance that it is within now; infinite if never."""
    days = STEP * np.arange(round(float(one.time[-1]) / STEP), round(YEARS / STEP))
    kinds = [_drawn(kind, one, law, days, rng) for kind in law.kinds]
    logs = np.stack([kind.log_weight for kind in kinds])
    rough = np.cumsum(np.exp(logs - logs.max()))
    picked = np.searchsorted(rough, rough[-1] * (np.arange(FOLLOWED) + rng.uniform()) / FOLLOWED)
    found = [_passed(kind.future(picked[picked // DRAWS == i] % DRAWS)) for i, kind in enumerate(kinds)]
    passed = np.concatenate(found)
    return np.asarray(passed[passed > 0])


def _passed(deviation: Array) -> Array:
    """(m,) years until deviations (m, t) are out of tolerance; infinite if never."""
    beyond = np.abs(deviation) >= 1
    return np.where(beyond.any(axis=1), STEP * beyond.argmax(axis=1), np.inf)


def _drawn(kind: str, one: History, law: Law, days: Array, rng: Random) -> _Kind:
    if kind == law.wanders:
        return _wandering(one, law, days, rng)
    if kind == law.seasonal:
        return _weathered(one, law, days, rng)
    if kind in law.sized:
        return _sized(one, law, law.sized[kind], days, rng)
    return _unsized(one, law, np.zeros((DRAWS, len(one.time))), lambda chosen: np.zeros((len(chosen), len(days))), rng)


def _signs(one: History) -> Array:
    """(n,) sign of e₀ in every reading: plus in the reference itself, minus in all others."""
    return np.append(1.0, np.full(len(one.time) - 1, -1.0))


def _sized(one: History, law: Law, of: Sized, days: Array, rng: Random) -> _Kind:
    """Sizes and e₀ of courses."""
    course = of.courses(DRAWS, rng)
    shape, weight, sign = course(one.time), one.sigma**-2.0, _signs(one)
    cross = (weight * sign * shape).sum(axis=1)
    normal = np.stack([(weight * shape**2).sum(axis=1) + of.typical**-2.0, cross, cross, np.full(DRAWS, weight.sum())])
    covariance = np.linalg.inv(normal.T.reshape(-1, 2, 2))
    pull = np.stack([shape @ (weight * one.value), np.full(DRAWS, (weight * sign) @ one.value)], axis=1)
    root, steps = WIDE * np.linalg.cholesky(covariance), rng.standard_t(TAILS, (DRAWS, 2))
    size, origin = (np.einsum("nij,nj->ni", covariance, pull) + np.einsum("nij,nj->ni", root, steps)).T
    density = stats.t.logpdf(steps, TAILS).sum(axis=1) - np.log(np.diagonal(root, axis1=1, axis2=2)).sum(axis=1)
    log = of.log_prior(size) + _log_likelihood(one, law, size[:, None] * shape, origin) - density
    return _Kind(log, lambda chosen: size[chosen, None] * course(days)[chosen] - origin[chosen, None])


def _unsized(one: History, law: Law, moved: Array, ahead: Callable[[Array], Array], rng: Random) -> _Kind:
    """e₀ of what moved by (N, n) since the reference; ``ahead`` that in future."""
    weight, steps = one.sigma**-2.0, rng.standard_t(TAILS, DRAWS)
    scale = WIDE * weight.sum() ** -0.5
    origin = (one.value - moved) @ (weight * _signs(one)) / weight.sum() + scale * steps
    log = _log_likelihood(one, law, moved, origin) - stats.t.logpdf(steps, TAILS) + np.log(scale)
    return _Kind(log, lambda chosen: ahead(chosen) - origin[chosen, None])


def _log_likelihood(one: History, law: Law, moved: Array, origin: Array) -> Array:
    """(N,) log likelihood of readings that moved by (N, n) since the reference, whose error is ``origin`` (N,), T."""
    errors = np.column_stack([origin, one.value[1:] - moved[:, 1:] + origin[:, None]])
    return np.asarray((law.log_error(errors / one.sigma) - np.log(one.sigma)).sum(axis=1))


def _weathered(one: History, law: Law, days: Array, rng: Random) -> _Kind:
    """One that follows the air, which was measured at every session; that of the future is of any year."""
    mean, scatter = law.thermometer
    felt = one.temperature - mean - scatter * rng.standard_normal((DRAWS, len(one.time)))
    slope = rng.choice([-1.0, 1.0], DRAWS) * rng.uniform(*law.slopes, DRAWS)

    def ahead(chosen: Array) -> Array:
        come = np.array([law.air(days, rng) for _ in chosen]).reshape(len(chosen), len(days))
        come[:, 0] = felt[chosen, -1]
        return np.asarray(slope[chosen, None] * (come - felt[chosen, :1]))

    return _unsized(one, law, slope[:, None] * (felt - felt[:, :1]), ahead, rng)


def _wandering(one: History, law: Law, days: Array, rng: Random) -> _Kind:
    """Draws of a parameter that wanders between sessions; its evidence is that of the later readings given e₀."""
    scale, log = rng.uniform(*law.scales, DRAWS), 0.0
    value = -one.sigma[0] * law.errors(DRAWS, rng)
    for i, steps in enumerate(np.round(np.diff(one.time) / STEP).astype(int), start=1):
        value = value + law.steps(scale, int(steps), rng)
        weight = np.exp(law.log_error((one.value[i] - value) / one.sigma[i])) / one.sigma[i]
        log += float(np.log(max(weight.mean(), 1e-300)))
        rough = np.cumsum(np.maximum(weight, 1e-300))
        kept = np.searchsorted(rough, rough[-1] * (np.arange(DRAWS) + rng.uniform()) / DRAWS)
        kept = np.minimum(kept, DRAWS - 1)
        value, scale = value[kept], scale[kept]

    def ahead(chosen: Array) -> Array:
        come = law.steps(np.repeat(scale[chosen, None], len(days), axis=1), 1, rng)
        come[:, 0] = 0.0
        return np.asarray(value[chosen, None] + np.cumsum(come, axis=1))

    return _Kind(np.full(DRAWS, log), ahead)
