"""Least squares against `numpy` and closed forms."""

import numpy as np
import pytest

from estimator.least_squares import given, inverse, least_squares, orthonormal

RNG = np.random.default_rng(4)
X, Y = RNG.standard_normal((12, 3)) * [1.0, 1e6, 1e-6], RNG.standard_normal(12)


def test_value_covariance_and_what_is_left_are_those_of_the_normal_equations() -> None:
    fit = least_squares(X, Y)
    expected, left, *_ = np.linalg.lstsq(X, Y, rcond=1e-15)
    assert fit.value == pytest.approx(expected)
    assert fit.covariance == pytest.approx(np.linalg.inv(X.T @ X), rel=1e-6)
    assert (fit.rank, fit.freedom, float(fit.chi2)) == (3, 9, pytest.approx(float(left[0])))


def test_columns_that_say_the_same_share_what_they_explain() -> None:
    fit = least_squares(X[:, [0, 0]], Y)
    assert (fit.rank, fit.freedom) == (1, 11)
    assert fit.value == pytest.approx(2 * [least_squares(X[:, :1], Y).value[0] / 2])


def test_a_prior_is_one_more_reading_of_zero() -> None:
    """y = 3 ± 1 and a ~ N(0, 2²): the posterior is N(3·4/5, 4/5)."""
    fit = least_squares(np.ones((1, 1)), np.array([3.0]), prior=np.array([0.25]))
    assert (fit.value[0], fit.covariance[0, 0]) == pytest.approx((2.4, 0.8))


def test_what_is_left_free_takes_its_share_of_scores_and_information() -> None:
    score, left = given(X.T @ Y, X.T @ X, [1], 1e-4)
    basis = orthonormal(X[:, 1:2], 1e-6)
    rest, z = X - basis @ (basis.T @ X), Y - basis @ (basis.T @ Y)
    assert left[0, 2] == pytest.approx((rest.T @ rest)[0, 2])
    assert score[[0, 2]] == pytest.approx((rest.T @ z)[[0, 2]])
    assert (score[1], left[1, 1]) == (0.0, 0.0)


def test_an_information_of_nothing_has_no_inverse() -> None:
    assert inverse(np.diag([4.0, 0.0])).tolist() == [[0.25, 0.0], [0.0, 0.0]]
    assert inverse(np.zeros((0, 0))).shape == (0, 0)
