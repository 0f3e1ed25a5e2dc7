"""Tails of χ² and F against printed tables and `scipy.stats`."""

import numpy as np
import pytest
from scipy.stats import chi2, f

from estimator.significance import critical_chi2, equivalent_chi2, family_wise, p_value, single_level


def test_estimated_noise_asks_for_more_than_stated_noise() -> None:
    """Table of F, 2 and 10 degrees, 0.1 %: 14.91 (Box, Hunter and Hunter 2005, table D)."""
    assert critical_chi2(0.001, 2, 10.0) == pytest.approx(2 * 14.91, rel=1e-3)
    assert critical_chi2(0.001, 2) == pytest.approx(13.816, rel=1e-4)
    assert critical_chi2(0.001, 2, np.inf) == critical_chi2(0.001, 2)


@pytest.mark.parametrize("freedom", [None, 7.5])
def test_a_critical_value_is_exceeded_with_its_probability(freedom: float | None) -> None:
    assert float(p_value(critical_chi2(0.003, 4, freedom), 4, freedom)) == pytest.approx(0.003)


def test_a_chi_square_of_nothing_says_nothing() -> None:
    assert p_value(np.array([0.0, 4.0, -1e-9]), np.array([0, 1, 2])) == pytest.approx([1.0, 0.0455003, 1.0])


def test_levels_of_several_tests() -> None:
    assert 1 - (1 - single_level(0.01, 7)) ** 7 == pytest.approx(0.01)
    assert (family_wise(0.002, 10), family_wise(0.2, 10)) == (0.02, 1.0)


@pytest.mark.parametrize(("power", "q"), [(9.0, 1), (40.0, 2)])
def test_an_f_becomes_the_chi_square_of_the_same_tail(power: float, q: int) -> None:
    (found,) = equivalent_chi2(np.array([power]), np.array([q]), np.array([20.0]), np.array([25.0]))
    assert chi2.sf(found, q) == pytest.approx(f.sf(power / q / (20 / 25), q, 25))


def test_a_tail_beyond_doubles_still_grows() -> None:
    one = np.ones(2)
    near, far = equivalent_chi2(np.array([1e4, 1e5]), one.astype(int), one, one * 200)
    assert near < far < np.inf
