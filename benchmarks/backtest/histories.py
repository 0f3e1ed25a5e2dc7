"""Histories: what truly happens to a parameter, in tolerances, and the sessions that see it at irregular dates."""

from dataclasses import dataclass

import numpy as np

from estimator.health.trend import Series
from estimator.session import Array

STEP = 0.02
"""Years between points of a truth."""
YEARS = 16.0
MEASURED = 4.0
"""Years in which sessions are held."""
KINDS = ("stable", "walk", "ramp", "step", "temperature")
DESCRIBED = {
    "stable": "nothing moves",
    "walk": "random walk, 0.05 to 0.5 T a root year (log-uniform)",
    "ramp": "0.1 to 0.8 T a year, either way, and a walk of 0.03",
    "step": "0.4 to 1.2 T once within the measured time, either way, and a walk of 0.03",
    "temperature": "a yearly swing of 0.05 to 0.3 T, and a walk of 0.03",
}


@dataclass(frozen=True, eq=False)
class History:
    """One parameter's life."""

    kind: str
    truth: Array
    """Every STEP years from 0, counted from the reference session."""
    onset: float
    """Years; when a ramp or a step begins."""
    series: Series
    """All its sessions, the reference first."""

    def first(self, sessions: int) -> Series:
        """What is known after so many sessions."""
        s = self.series
        return Series(s.time[:sessions], s.value[:sessions], s.sigma[:sessions], 1.0)


def histories(
    kind: str, count: int, rng: np.random.Generator, *, late: bool = False, sigma: float | None = None
) -> list[History]:
    """So many histories of a kind; with ``late`` a ramp begins after a while, as a drift that is to be detected."""
    return [_history(kind, rng, late, sigma) for _ in range(count)]


def _history(kind: str, rng: np.random.Generator, late: bool, sigma: float | None) -> History:
    time = STEP * np.arange(round(YEARS / STEP))
    onset = float(rng.uniform(0.5, 2.0)) if late or kind == "step" else 0.0
    truth = _walk(len(time), _strength(kind, rng), rng) + _course(kind, time, onset, rng)
    sessions = int(rng.integers(8, 17))
    dates = np.unique(np.concatenate([[0], rng.integers(1, round(MEASURED / STEP), sessions - 1)]))
    own = sigma or float(np.exp(rng.uniform(np.log(0.03), np.log(0.2))))
    error = own * rng.standard_normal(len(dates))
    recorded = truth[0] + error[0]
    return History(
        kind, truth - recorded, onset,
        Series(time[dates], truth[dates] + error - recorded, np.full(len(dates), own), 1.0),
    )  # fmt: skip


def _strength(kind: str, rng: np.random.Generator) -> float:
    if kind == "walk":
        return float(np.exp(rng.uniform(np.log(0.05), np.log(0.5))))
    return 0.0 if kind == "stable" else 0.03


def _walk(points: int, strength: float, rng: np.random.Generator) -> Array:
    steps = strength * np.sqrt(STEP) * rng.standard_normal(points)
    steps[0] = 0.0
    return np.cumsum(steps)


def _course(kind: str, time: Array, onset: float, rng: np.random.Generator) -> Array:
    sign = rng.choice([-1.0, 1.0])
    if kind == "ramp":
        return sign * rng.uniform(0.1, 0.8) * np.maximum(time - onset, 0.0)
    if kind == "step":
        return sign * rng.uniform(0.4, 1.2) * (time >= onset)
    if kind == "temperature":
        return rng.uniform(0.05, 0.3) * np.sin(2 * np.pi * (time + rng.uniform()))
    return np.zeros_like(time)
