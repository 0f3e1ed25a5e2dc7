"""Histories: what truly happens to a parameter, in tolerances, and the sessions that see it at uneven dates.

Nothing here is shared with the estimator, and sizes and shapes are not those that it assumes: sizes are uniform where
it takes them for normal, aging is exponential where it takes it for logarithmic, swings follow the season.
"""

from dataclasses import dataclass

import numpy as np

from estimator.session import Array

STEP = 0.02
"""Years between points of a truth."""
YEARS = 20.0
"""Length of a truth: the longest history and the time after it."""
DESCRIBED = {
    "stable": "nothing moves",
    "step": "0.4 to 1.2 T, once, between two sessions or at a service that nobody recorded",
    "ramp": "0.2 to 0.8 T a year from the start",
    "late ramp": "0.2 to 0.8 T a year, from some day on",
    "aging": "0.5 to 1.2 T in the end, exponential with 0.3 to 1.5 years",
    "walk": "random walk, 0.1 to 0.4 T a root year",
    "seasonal": "0.02 to 0.06 T per °C, with a laboratory that is 3 to 6 °C warmer in summer than in winter",
}


@dataclass(frozen=True, eq=False)
class History:
    """One parameter's life."""

    kind: str
    truth: Array
    """(points,) every STEP years, deviation from the value that the reference session recorded; T."""
    onset: float
    """Years; when a ramp or a step begins."""
    time: Array
    """(n,) years of the sessions, the reference first."""
    value: Array
    """(n,) deviations as measured, T."""
    sigma: Array
    """(n,) standard uncertainties, T."""
    temperature: Array
    """(n,) °C."""

    @property
    def passed(self) -> float:
        """Years from the last session until the truth is out of tolerance; infinite if never."""
        beyond = np.abs(self.truth[round(float(self.time[-1]) / STEP) :]) >= 1
        return float(STEP * np.argmax(beyond)) if beyond.any() else float("inf")


@dataclass(frozen=True)
class Plan:
    """Schedule and accuracy of a unit's sessions."""

    sessions: tuple[int, int] = (6, 16)
    """Fewest and most."""
    sigma: tuple[float, float] = (0.03, 0.15)
    """T, least and largest of a unit; its sessions differ by a third either way."""
    since: int = 0
    """Sessions, at least, from the onset of a change on; 0 where it may come any time."""
    freedom: float = np.inf
    """Degrees of freedom of Student's law of an error, of the stated standard deviation; infinite for a normal one."""


def dates(plan: Plan, rng: np.random.Generator) -> Array:
    """(n,) years: intervals of one to eight months, as workshops keep them."""
    sessions = int(rng.integers(plan.sessions[0], plan.sessions[1] + 1))
    gaps = np.maximum(np.round(rng.uniform(1 / 12, 8 / 12, sessions - 1) / STEP), 1) * STEP
    time = np.concatenate([[0.0], np.cumsum(gaps)])
    return time * min(1.0, (YEARS - 6) / max(time[-1], STEP))


def history(kind: str, time: Array, plan: Plan, rng: np.random.Generator) -> History:
    """One parameter of a unit that is measured at (n,) years ``time``."""
    days = STEP * np.arange(round(YEARS / STEP))
    at = np.round(time / STEP).astype(int)
    onset = _onset(kind, time, plan, rng)
    warmth = rng.uniform(3, 6) * np.sin(2 * np.pi * (days + rng.uniform()))
    truth = _course(kind, days, (onset, warmth), rng)
    unit = np.exp(rng.uniform(*np.log(plan.sigma)))
    sigma = unit * rng.uniform(0.75, 1.33, len(time))
    error = sigma * errors(plan.freedom, len(time), rng)
    recorded = truth[0] + error[0]
    temperature = 21 + warmth[at] + 0.5 * rng.standard_normal(len(time))
    return History(kind, truth - recorded, onset, STEP * at, truth[at] + error - recorded, sigma, temperature)


def errors(freedom: float, count: int, rng: np.random.Generator) -> Array:
    """(count,) errors in standard deviations."""
    if np.isinf(freedom):
        return rng.standard_normal(count)
    return rng.standard_t(freedom, count) * np.sqrt((freedom - 2) / freedom)


def _onset(kind: str, time: Array, plan: Plan, rng: np.random.Generator) -> float:
    if kind not in ("step", "late ramp"):
        return 0.0
    if plan.since:
        return float(rng.uniform(time[0], time[-1 - plan.since]))
    return float(rng.uniform(0, YEARS / 2))


def _course(kind: str, days: Array, of: tuple[float, Array], rng: np.random.Generator) -> Array:
    """(points,) T; ``of`` is the onset, years, and the warmth of every day, °C."""
    (onset, warmth), sign = of, rng.choice([-1.0, 1.0])
    if kind == "step":
        return sign * rng.uniform(0.4, 1.2) * (days >= onset)
    if kind in ("ramp", "late ramp"):
        return sign * rng.uniform(0.2, 0.8) * np.maximum(days - onset, 0.0)
    if kind == "aging":
        return -sign * rng.uniform(0.5, 1.2) * np.expm1(-days / rng.uniform(0.3, 1.5))
    if kind == "walk":
        return rng.uniform(0.1, 0.4) * np.sqrt(STEP) * np.cumsum(rng.standard_normal(len(days)))
    return sign * rng.uniform(0.02, 0.06) * warmth if kind == "seasonal" else np.zeros_like(days)
