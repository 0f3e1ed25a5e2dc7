"""The probability of a disc against the noncentral chi-square and against draws; limits of a length against draws."""

import numpy as np
import pytest
from scipy import stats

from estimator.health.disc import beyond_discs, disc_probability, judge_length


@pytest.mark.parametrize("sigma", [0.05, 0.5, 1.0, 3.0])
@pytest.mark.parametrize("center", [0.0, 0.4, 1.0, 2.5])
def test_equal_variances_are_noncentral_chi_square(sigma: float, center: float) -> None:
    found = disc_probability(np.array([0.6, 0.8]) * center, np.array([sigma, sigma]), 1.0)
    assert found == pytest.approx(stats.ncx2.cdf(1 / sigma**2, 2, (center / sigma) ** 2), abs=1e-10)


@pytest.mark.parametrize("sigma", [(0.1, 0.8), (0.02, 0.5), (0.3, 1.5)])
@pytest.mark.parametrize("center", [(0.0, 0.0), (0.7, 0.2), (0.1, 1.1), (1.0, 0.9)])
def test_unequal_variances_agree_with_draws(sigma: tuple[float, float], center: tuple[float, float]) -> None:
    draws = np.array(center) + np.array(sigma) * np.random.default_rng(5).standard_normal((400_000, 2))
    share = np.mean(np.hypot(*draws.T) <= 1)
    assert disc_probability(np.array(center), np.array(sigma), 1.0) == pytest.approx(share, abs=4 * 0.5 / 400_000**0.5)


def test_a_disc_without_area_holds_nothing() -> None:
    assert disc_probability(np.zeros(2), np.ones(2), 0.0) == 0


@pytest.mark.slow
@pytest.mark.parametrize("sigma", [(1.0, 1.0), (0.3, 1.0)])
@pytest.mark.parametrize("length", [2.0, 4.0, 8.0])
def test_limits_hold_the_true_length_as_often_as_they_claim(sigma: tuple[float, float], length: float) -> None:
    """Each limit is wrong in at most Φ(−2) = 2.3 %, in the least favourable direction and in the other; equal sigmas
    have one direction.
    """
    rng = np.random.default_rng(6)
    for center in ((0.0, length), (length, 0.0))[: len(set(sigma))]:
        draws = np.array(center) + np.array(sigma) * rng.standard_normal((500, 2))
        found = [judge_length(d, np.diag(np.square(sigma)), 5.0, 2.0) for d in draws]
        above = np.mean([length > f.value + f.expanded for f in found])
        below = np.mean([length < f.value - f.expanded for f in found])
        assert max(above, below) < 0.0228 + 3 * np.sqrt(0.0228 / 500)


@pytest.mark.slow
def test_the_length_is_freed_of_the_upward_pull_of_noise() -> None:
    """Noise of one sigma lengthens a vector of two by a quarter of a sigma; the median of the estimate is two."""
    draws = np.array([0.0, 2.0]) + np.random.default_rng(8).standard_normal((4000, 2))
    assert np.median(np.hypot(*draws.T)) > 2.15
    assert np.median([judge_length(d, np.eye(2), 5.0, 2.0).value for d in draws]) == pytest.approx(2.0, abs=0.07)


def test_what_noise_explains_has_no_length() -> None:
    assert judge_length(np.array([0.5, 0.5]), np.eye(2), 5.0, 2.0).value == 0
    assert judge_length(np.zeros(2), np.eye(2), 5.0, 2.0).expanded == pytest.approx(2.0)


def test_the_risk_of_a_disc_is_that_of_the_decision_and_more_than_that_of_a_square() -> None:
    """Two axes at 0.8 of the tolerance, along one component and along both."""
    centers = np.array([[0.8, 0.0], [0.8 / np.sqrt(2), 0.8 / np.sqrt(2)]])
    risk = beyond_discs(centers, np.full((2, 2), 0.2), 1.0)
    assert risk[0] == pytest.approx(risk[1])
    assert risk[1] == pytest.approx(judge_length(centers[1], 0.04 * np.eye(2), 1.0, 2.0).probability_beyond)
    square = 1 - np.prod(stats.norm.cdf(1.0, centers[1], 0.2) - stats.norm.cdf(-1.0, centers[1], 0.2))
    assert risk[1] > 3 * square


def test_the_order_of_the_components_does_not_matter() -> None:
    one = beyond_discs(np.array([[0.2, 0.9]]), np.array([[0.05, 0.5]]), 1.0)
    other = beyond_discs(np.array([[0.9, 0.2]]), np.array([[0.5, 0.05]]), 1.0)
    assert one == pytest.approx(other, abs=1e-12)


@pytest.mark.parametrize("sigma", [(0.0, 0.0), (0.0, 1e-9), (1e-9, 0.0)])
@pytest.mark.parametrize(("center", "beyond"), [((0.6, 0.6), 0.0), ((0.8, 0.8), 1.0)])
def test_what_is_known_exactly_is_in_the_disc_or_beyond(
    sigma: tuple[float, float], center: tuple[float, float], beyond: float
) -> None:
    assert beyond_discs(np.array([center]), np.array([sigma]), 1.0) == pytest.approx([beyond], abs=1e-9)
    length = judge_length(np.array(center), np.diag(np.square(sigma)), 1.0, 2.0)
    assert (length.value, length.expanded) == pytest.approx((np.hypot(*center), 0.0), abs=1e-8)
    assert length.probability_beyond == pytest.approx(beyond, abs=1e-9)
