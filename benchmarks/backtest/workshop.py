"""A second generator, of workshops as they are: it shares no law with the first one or with the estimator.

Dates come in campaigns and with long gaps, errors of measurement have heavy tails (Student's, four degrees of freedom,
with the standard deviation that is stated), onsets follow a hazard and are no sharp bends, sizes are log-normal over a
decade, aging is hyperbolic, wandering is many small shocks, the laboratory is heated in winter only.
"""

import numpy as np

from benchmarks.backtest.histories import STEP, YEARS, History, Plan, errors
from estimator.session import Array

TAILS = 4.0
"""Degrees of freedom of an error."""
CAMPAIGN = 0.3
"""Share of sessions that follow the one before within three weeks."""
PAUSE, UNEVEN = 0.3, 0.8
"""Years, the median of other gaps, and the standard deviation of their logarithm."""
HAZARD = 1.5
"""Years, the mean time until something happens."""
BEND = 0.25
"""Years within which a late drift takes up its rate."""
SHOCKS = 6.0
"""A year, of one that wanders."""
HEATED = 1 / 3
"""Part of the year in which the laboratory is kept warm; without heating it follows the weather."""
DESCRIBED = {
    "still": "nothing moves",
    "shock": "log-normal about 0.5 T, once, at a time of exponential law",
    "shock and back": "the same, and within two years the same back again",
    "creep": "log-normal about 0.3 T a year from the start",
    "late creep": "the same from a time of exponential law on, taking up its rate within three months",
    "settling": "log-normal about 0.7 T in the end, as t/(t + τ) with 0.1 to 2 years",
    "small shocks": "six a year, Laplace's, together 0.1 to 0.4 T a root year",
    "unheated": "0.02 to 0.06 T per °C, with a laboratory that is cold but for four months a year",
}


def dates(plan: Plan, rng: np.random.Generator) -> Array:
    """(n,) years: campaigns and long gaps."""
    n = int(rng.integers(plan.sessions[0], plan.sessions[1] + 1)) - 1
    gaps = np.exp(np.log(PAUSE) + UNEVEN * rng.standard_normal(n))
    gaps = np.where(rng.uniform(size=n) < CAMPAIGN, rng.uniform(0, 3 / 52, n), gaps)
    total = max(float(gaps.sum()) / (YEARS - 6), 1.0)
    time = np.concatenate([[0.0], np.cumsum(np.maximum(np.round(gaps / total / STEP), 1.0) * STEP)])
    return np.asarray(time[time <= YEARS - 5])


def history(kind: str, time: Array, plan: Plan, rng: np.random.Generator) -> History:
    """One parameter of a unit that is measured at (n,) years ``time``."""
    days = STEP * np.arange(round(YEARS / STEP))
    at = np.round(time / STEP).astype(int)
    warmth = weather(days, rng)
    onset = _onset(kind, time, plan, rng)
    truth = _course(kind, days, (onset, warmth), rng)
    sigma = np.exp(rng.uniform(*np.log(plan.sigma))) * np.exp(0.25 * rng.standard_normal(len(time)))
    error = sigma * errors(plan.freedom, len(time), rng)
    recorded = truth[0] + error[0]
    temperature = 20 + warmth[at] + 0.3 * rng.standard_normal(len(time))
    return History(kind, truth - recorded, onset, STEP * at, truth[at] + error - recorded, sigma, temperature)


def weather(days: Array, rng: np.random.Generator) -> Array:
    """(points,) °C about 20: flat while it is heated, otherwise up to ten degrees colder, with weeks of their own."""
    season = (days + rng.uniform()) % 1.0
    swing = np.where(season < HEATED, 0.0, np.sin(np.pi * (season - HEATED) / (1 - HEATED)))
    return np.asarray(-rng.uniform(6, 10) * swing + rng.standard_normal(len(days)))


def _onset(kind: str, time: Array, plan: Plan, rng: np.random.Generator) -> float:
    """Years; of a law that takes no notice of sessions, but for those that it must leave."""
    if kind not in ("shock", "shock and back", "late creep"):
        return 0.0
    latest = float(time[-1 - plan.since]) if plan.since else YEARS
    whole = -np.expm1(-latest / HAZARD)
    return float(-HAZARD * np.log1p(-rng.uniform() * whole))


def _course(kind: str, days: Array, of: tuple[float, Array], rng: np.random.Generator) -> Array:
    """(points,) T; ``of`` is the onset, years, and the weather of every day, °C."""
    (onset, warmth), sign = of, rng.choice([-1.0, 1.0])
    size = sign * np.exp(0.5 * rng.standard_normal())
    if kind == "shock":
        return 0.5 * size * (days >= onset)
    if kind == "shock and back":
        return 0.5 * size * ((days >= onset) & (days < onset + rng.uniform(0.2, 2.0)))
    if kind in ("creep", "late creep"):
        late, bend = np.maximum(days - onset, 0.0), BEND if onset else 0.0
        return 0.3 * size * np.where(late < bend, late**2 / (2 * BEND), late - bend / 2)
    if kind == "settling":
        return 0.7 * size * days / (days + rng.uniform(0.1, 2.0))
    if kind == "small shocks":
        each = rng.uniform(0.1, 0.4) / np.sqrt(2 * SHOCKS)
        return np.cumsum(rng.laplace(0.0, each, len(days)) * (rng.uniform(size=len(days)) < SHOCKS * STEP))
    return sign * rng.uniform(0.02, 0.06) * warmth if kind == "unheated" else np.zeros_like(days)
