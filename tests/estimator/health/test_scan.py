"""A scan over neighbouring dates costs what it may mislead, and no more than a count of the dates."""

import numpy as np
import pytest
from scipy import stats

from estimator.health.scan import looks


@pytest.mark.parametrize("size", [1, 3])
@pytest.mark.parametrize("correlation", [0.5, 0.9, 0.98])
def test_scores_along_dates_exceed_the_level_as_rarely_as_stated(size: int, correlation: float) -> None:
    rng, dates, level = np.random.default_rng([size, int(100 * correlation)]), 60, 0.05
    u, best = rng.standard_normal((8000, size)), np.zeros(8000)
    for _ in range(dates):
        best = np.maximum(best, (u**2).sum(axis=1))
        u = correlation * u + np.sqrt(1 - correlation**2) * rng.standard_normal(u.shape)
    worth = looks(np.full(dates - 1, correlation), size, level)
    share = float(np.mean(best > stats.chi2.isf(level / worth, size)))
    assert level / 3 < share < level + 3 * np.sqrt(level / 8000)


def test_dates_that_share_all_sessions_are_one_look() -> None:
    assert looks(np.ones(99), 3, 0.01) == pytest.approx(1.0, abs=0.01)


def test_dates_that_share_none_are_as_many_looks() -> None:
    assert looks(np.zeros(99), 1, 0.01) == pytest.approx(100.0, rel=0.02)
