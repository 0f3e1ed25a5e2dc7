"""Whether a parameter that follows the season is seen to follow the temperature."""

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtri

from benchmarks.backtest.histories import History, Plan, dates, history
from benchmarks.backtest.units import track
from estimator.health.detection import LEVEL
from estimator.health.pooled import general_prior
from estimator.health.prognosis import prognosis

SEASONS = Plan(sessions=(8, 20), sigma=(0.03, 0.1))
"""Two years and more."""


@dataclass(frozen=True)
class Followed:
    """Whether a coefficient is found at 1 %, and whether somebody would find it who knows that nothing else moves."""

    here: bool
    best: bool


def followed(kind: str, count: int, rng: np.random.Generator) -> list[Followed]:
    """Draws histories of a kind and follows each."""
    return [_followed(history(kind, dates(SEASONS, rng), SEASONS, rng)) for _ in range(count)]


def _followed(one: History) -> Followed:
    warmth = prognosis([track(one)], [general_prior()], np.zeros(1)).outlooks[0].warmth
    weight = one.sigma**-2.0
    warm = one.temperature - np.average(one.temperature, weights=weight)
    score, information = float(np.sum(weight * warm * one.value)), float(np.sum(weight * warm**2))
    return Followed(warmth is not None and warmth.is_found, abs(score) > -ndtri(LEVEL / 2) * np.sqrt(information))
