"""Detects growth of a noise term from one record to the next, over all sensors of a kind.

Sizes are compared as logarithms. Each scatters by its own variance, (σ/value)², and from record to record by what all
sensors scatter by beyond that; with the degrees of freedom of the latter a change over its sigma is Student's t. Where
no sensor has more than one record before the newest, nothing is known of that scatter, and only the former counts.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import stdtrit

from estimator.session import Array

WORTH = 1.25
"""Growth below which nothing is said: data sheets leave more room, and temperature makes as much."""


@dataclass(frozen=True, eq=False)
class GrowthCourse:
    """One term of one sensor through two records or more, oldest first."""

    value: Array
    """(n,) sizes, above 0, SI."""
    sigma: Array
    """(n,) one sigma of each, above 0, SI."""


@dataclass(frozen=True)
class Growth:
    """The newest size against those before."""

    usual: float
    """Geometric mean of those before, SI."""
    times: float
    """The newest over it."""
    is_larger: bool
    """Whether it is larger by more than chance, and by more than `WORTH`."""


def growth(courses: Sequence[GrowthCourse], level: float) -> tuple[Growth, ...]:
    """Growth of each course of a term and a kind of sensor; ``level``: chance of a false ``is_larger``, for each."""
    logs = [np.log(course.value) for course in courses]
    variances = [(course.sigma / course.value) ** 2 for course in courses]
    freedom, beyond = _excess_spread(logs, variances)
    limit = -float(stdtrit(freedom or np.inf, level))
    growths = []
    for log, variance in zip(logs, variances, strict=True):
        usual, change = log[:-1].mean(), log[-1] - log[:-1].mean()
        sigma = np.sqrt(variance[-1] + beyond + (variance[:-1].mean() + beyond) / (len(log) - 1))
        is_larger = change > max(limit * sigma, np.log(WORTH))
        growths.append(Growth(float(np.exp(usual)), float(np.exp(change)), bool(is_larger)))
    return tuple(growths)


def _excess_spread(logs: Sequence[Array], variances: Sequence[Array]) -> tuple[int, float]:
    """Degrees of freedom, and the variance of earlier sizes beyond what their own variances explain."""
    freedom = sum(len(log) - 2 for log in logs)
    if freedom == 0:
        return 0, 0.0
    squares = sum(float(((log[:-1] - log[:-1].mean()) ** 2).sum()) for log in logs)
    inner = sum((len(log) - 2) * float(variance[:-1].mean()) for log, variance in zip(logs, variances, strict=True))
    return freedom, max(0.0, squares - inner) / freedom
