"""Outliers of a population."""

from collections.abc import Sequence

import numpy as np
import pytest
from scipy import stats

from estimator.health.population import group_standing, outliers, spread, standing
from estimator.session import Array


def standings(rates: Sequence[tuple[float, float]]) -> Array:
    """Standings of rates with their sigmas, among themselves."""
    values, sigmas = np.array(rates, dtype=float).T
    return standing(values, sigmas, *spread(values, sigmas))


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
    z = standings([(v, 0.3) for v in values])
    assert min(z[:10]) > 8
    assert max(abs(x) for x in z[10:]) < 5


def test_ordinary_members_keep_the_level() -> None:
    rng = np.random.default_rng(4)
    z = [x for _ in range(50) for x in standings([(v, 0.5) for v in rng.normal(0, 1.1, 60)])]
    assert np.mean(np.abs(z) > 1.96) == pytest.approx(0.05, abs=0.02)
    assert stats.skew(z) == pytest.approx(0, abs=0.2)


def test_equal_rates_are_all_in_the_middle() -> None:
    assert list(standings([(1.0, 0.0), (1.0, 0.0), (1.0, 0.0)])) == [0.0, 0.0, 0.0]


@pytest.mark.parametrize("members", [1, 10, 300])
def test_the_furthest_of_all_stands_out_at_the_level_of_all(members: int) -> None:
    """P(the largest of n |z| is beyond) = 1 %."""
    beyond = stats.norm.isf((1 - 0.99 ** (1 / members)) / 2)
    others = [0.0] * (members - 1)
    assert outliers([0.999 * beyond, *others])[0] is False
    assert outliers([-1.001 * beyond, *others])[0] is True


def test_of_nobody_nobody_stands_out() -> None:
    assert outliers([]) == ()


def test_a_group_stands_by_its_mean_and_what_its_members_are_known_to() -> None:
    rates = [(0.0, 1.0)] * 4 + [(1.0, 1.0), (3.0, 1.0)]
    assert group_standing(rates, ["", "", "", "", "L7", "L7"]) == {"L7": pytest.approx(2.0 / np.sqrt(2) * 2)}


def test_a_group_of_one_and_the_rest_are_no_groups() -> None:
    assert group_standing([(0.0, 1.0), (1.0, 1.0), (2.0, 1.0)], ["", "L1", ""]) == {}


def test_the_spread_of_the_population_weakens_a_group() -> None:
    rates = [(-3.0, 0.1), (3.0, 0.1), (-4.0, 0.1), (4.0, 0.1), (2.0, 0.1), (2.2, 0.1)]
    centre, tau = spread(*np.array(rates).T)
    found = group_standing(rates, ["", "", "", "", "L7", "L7"])
    assert found["L7"] == pytest.approx((2.1 - centre) / np.sqrt((tau**2 + 0.01) / 2))
