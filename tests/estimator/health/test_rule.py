"""The four states, the honest fifth, and the level that a session keeps."""

import numpy as np
import pytest
from scipy import stats

from estimator.health.rule import critical_factors, state

T, U = 10.0, 4.0


@pytest.mark.parametrize(
    ("size", "expected"),
    [
        (0.0, "pass"),
        (6.0, "pass"),
        (6.01, "conditional-pass"),
        (10.0, "conditional-pass"),
        (10.01, "conditional-fail"),
        (14.0, "conditional-fail"),
        (14.01, "fail"),
    ],
)
def test_the_four_states(size: float, expected: str) -> None:
    assert state(size, U, T, critical=7.0) == expected


def test_an_uncertainty_beyond_the_tolerance_decides_nothing() -> None:
    assert state(0.0, 10.1, T, critical=20.0) == "undecidable"
    assert state(100.0, 10.1, T, critical=20.0) == "undecidable"


def test_beyond_the_tolerance_but_no_change_at_the_level_of_the_session() -> None:
    assert state(12.0, 8.0, T, critical=14.0) == "undecidable"
    assert state(14.1, 8.0, T, critical=14.0) == "conditional-fail"


def test_factors_of_a_single_number_are_the_textbook_ones() -> None:
    scalar, vector = critical_factors(1)
    assert scalar == pytest.approx(2.5758293035489)  # normal, two-sided 1 %
    assert vector == pytest.approx(np.sqrt(9.2103403719762))  # chi-square, 2 degrees of freedom, 1 %


def test_factors_keep_the_level_over_independent_numbers() -> None:
    scalar, vector = critical_factors(24)
    assert (1 - 2 * stats.norm.sf(scalar)) ** 24 == pytest.approx(0.99)
    assert stats.chi2.cdf(vector**2, 2) ** 24 == pytest.approx(0.99)


def test_estimated_noise_asks_for_more() -> None:
    many, few = critical_factors(24, dof=1e7), critical_factors(24, dof=10)
    assert many == pytest.approx(critical_factors(24), rel=1e-5)
    assert few[0] > 1.4 * many[0]
    assert few[1] > 1.4 * many[1]
