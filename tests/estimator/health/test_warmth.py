"""A parameter that follows the temperature of its sessions along a line or a parabola."""

import numpy as np
import pytest

from estimator.health.fits import Readings
from estimator.health.warmth import Warmth, warmth_of
from estimator.session import Array

SIGMA = 0.03
LEVEL = 0.01
WARM = np.array([20.0, 27.0, 13.0, 30.0, 11.0, 24.0, 17.0, 29.0, 22.0, 12.0])
SLOPE, BEND = 0.02, 0.008
"""T per °C and T per °C²."""


def law(value: Array, warm: Array = WARM, rival: Array | None = None) -> Warmth:
    """The law of values (n,), T, measured every half year."""
    n = len(value)
    one = Readings(np.arange(n) / 2.0, value[:, None], np.full((n, 1), SIGMA), np.ones((n, 1)), np.ones(1))
    found = warmth_of(one, warm, rival, LEVEL)
    assert found is not None
    return found


def noise(number: int, n: int = len(WARM)) -> Array:
    return SIGMA * np.random.default_rng(number).standard_normal(n)


@pytest.mark.parametrize("bend", [0.0, BEND])
def test_a_law_is_found_with_its_form(bend: float) -> None:
    away = WARM - 20.0
    found = law(SLOPE * away + bend * away**2 + noise(1))
    assert (found.is_found, found.is_bent) == (True, bend > 0)


def test_a_parabola_whose_top_is_in_the_middle_is_found_without_any_slope() -> None:
    found = law(BEND * (WARM - WARM.mean()) ** 2 + noise(2))
    assert (found.is_found, found.is_bent) == (True, True)
    assert abs(found.size[1, 0] - BEND) < 3 * np.sqrt(found.covariance[0, 1, 1])


def test_what_a_step_of_temperature_is_worth_is_as_uncertain_as_stated() -> None:
    away, pulls = WARM - 20.0, []
    for number in range(200):
        worth, sigma = law(SLOPE * away + BEND * away**2 + noise(100 + number)).between(20.0, 32.0)
        pulls.append((worth[0] - SLOPE * 12 - BEND * 144) / sigma[0])
    assert 0.85 < np.std(pulls) < 1.15


def test_temperatures_at_two_values_bend_nothing() -> None:
    warm = np.array([15.0, 25.0] * 4)
    assert not law(SLOPE * (warm - 20) + noise(3, 8), warm).is_bent


def test_few_sessions_bend_nothing() -> None:
    assert not law(BEND * (WARM[:5] - 20) ** 2 + noise(4, 5), WARM[:5]).is_bent


def test_sound_histories_rarely_show_a_law() -> None:
    found = [law(noise(1000 + number)) for number in range(600)]
    assert sum(one.is_found for one in found) <= 12


def test_a_jump_is_not_taken_for_a_parabola_that_explains_less() -> None:
    jump = np.where(np.arange(len(WARM)) > 4, 1.0, 0.0)
    assert not law(jump + noise(5), rival=jump).is_found
