"""A noise is called larger rarely by chance, and always when it is much larger."""

import numpy as np
import pytest

from estimator.allan.growth import GrowthCourse, growth

SENSORS, LEVEL = 6, 0.01


def records(rng: np.random.Generator, count: int, *, beyond: float = 0.0, last: float = 1.0) -> list[GrowthCourse]:
    """White noise of size one, of six sensors in so many records, that scatters by ``beyond`` from record to record."""
    freedom = rng.choice([50.0, 2000.0], count)
    true = np.exp(beyond * rng.standard_normal((SENSORS, count)))
    true[:, -1] *= last
    value = true * np.sqrt(rng.chisquare(freedom, (SENSORS, count)) / freedom)
    return [GrowthCourse(own, own / np.sqrt(2 * freedom)) for own in value]


@pytest.mark.parametrize(("count", "beyond"), [(2, 0.0), (4, 0.0), (8, 0.1), (3, 0.3)])
def test_the_same_noise_is_hardly_ever_called_larger(count: int, beyond: float) -> None:
    rng, tried = np.random.default_rng(1), 400
    found = [one for _ in range(tried) for one in growth(records(rng, count, beyond=beyond), LEVEL)]
    assert sum(one.is_larger for one in found) <= 1.5 * LEVEL * len(found), "the level is met with room for chance"


def test_three_times_the_noise_is_larger_by_what_it_grew() -> None:
    found = growth(records(np.random.default_rng(2), 4, last=3.0), LEVEL)
    assert all(one.is_larger for one in found)
    assert [one.times for one in found] == pytest.approx([3.0] * SENSORS, rel=0.35)
    assert [one.usual for one in found] == pytest.approx([1.0] * SENSORS, rel=0.25)


def test_what_is_worth_no_words_is_not_larger_however_sure() -> None:
    sure = [GrowthCourse(np.array([1.0, 1.0, 1.2]), np.full(3, 1e-6))]
    assert not growth(sure, LEVEL)[0].is_larger
