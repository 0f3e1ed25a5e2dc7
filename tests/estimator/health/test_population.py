"""Who stands out of a population."""

import numpy as np
import pytest
from scipy import stats

from estimator.health.population import spread, standing


def test_a_population_that_agrees_has_no_spread_of_its_own() -> None:
    rng = np.random.default_rng(1)
    found = [spread(rng.standard_normal(40), np.ones(40))[1] for _ in range(200)]
    assert np.median(found) < 0.35


def test_the_spread_is_freed_of_the_members_own_uncertainty() -> None:
    rng = np.random.default_rng(2)
    sigmas = rng.uniform(0.5, 2.0, 2000)
    values = 3 + np.sqrt(4 + sigmas**2) * rng.standard_normal(2000)
    centre, tau = spread(values, sigmas)
    assert (centre, tau) == pytest.approx((3.0, 2.0), abs=0.2)


def test_a_third_of_wild_members_does_not_hide_them() -> None:
    rng = np.random.default_rng(3)
    values = rng.standard_normal(30)
    values[:10] += 40
    z = standing([(v, 0.3) for v in values])
    assert min(z[:10]) > 8
    assert max(abs(x) for x in z[10:]) < 5


def test_ordinary_members_keep_the_level() -> None:
    rng = np.random.default_rng(4)
    z = [x for _ in range(50) for x in standing([(v, 0.5) for v in rng.normal(0, 1.1, 60)])]
    assert np.mean(np.abs(z) > 1.96) == pytest.approx(0.05, abs=0.02)
    assert stats.skew(z) == pytest.approx(0, abs=0.2)


def test_equal_rates_are_all_in_the_middle() -> None:
    assert standing([(1.0, 0.0), (1.0, 0.0), (1.0, 0.0)]) == (0.0, 0.0, 0.0)
