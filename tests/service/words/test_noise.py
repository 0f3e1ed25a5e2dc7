"""What is said to have become noisier: rarely by chance, and always when it did."""

from dataclasses import replace

import numpy as np
import pytest

from service.records.history import HistoryPoint
from service.words.noise import LEVEL, NOT_DECIDED, grown, size_in_words
from tests.service.pages.records import bias_point

SENSORS = 6


def records(rng: np.random.Generator, count: int, *, beyond: float = 0.0, last: float = 1.0) -> list[HistoryPoint]:
    """White noise of size one, of six sensors in so many records, that scatters by ``beyond`` from record to record."""
    found = []
    for number in range(count):
        freedom = rng.choice([50.0, 2000.0])
        own = np.exp(beyond * rng.standard_normal(SENSORS)) * (last if number == count - 1 else 1.0)
        for k, true in enumerate(own):
            value = float(true * np.sqrt(rng.chisquare(freedom) / freedom))
            size = {"value": value, "u": value / np.sqrt(2 * freedom), "session": f"s{number}"}
            found.append(replace(bias_point(number, 1.0), sensor=f"A{k}", parameter="white-noise", **size))
    return found


@pytest.mark.parametrize(("count", "beyond"), [(2, 0.0), (4, 0.0), (8, 0.1)])
def test_the_same_noise_is_hardly_ever_called_larger(count: int, beyond: float) -> None:
    rng = np.random.default_rng(1)
    tried = 400
    said = sum(bool(grown(records(rng, count, beyond=beyond))) for _ in range(tried))
    assert said <= 3 * LEVEL * tried, "the level is met with room for chance"


def test_twice_the_noise_is_told_once_for_all_sensors() -> None:
    (sentence,) = grown(records(np.random.default_rng(2), 3, last=2.0))
    assert sentence.startswith("White noise N is larger in all accelerometers: ")


def test_a_single_sensor_is_named() -> None:
    points = records(np.random.default_rng(3), 3)
    last = points[-1]
    assert last.value is not None
    (sentence,) = grown([*points[:-1], replace(last, value=3 * last.value, u=3 * (last.u or 0.0))])
    assert sentence.startswith("White noise N of A5 is ")


def test_what_is_not_decided_is_no_number() -> None:
    assert size_in_words("gyroscope", "random-walk", None, None) == NOT_DECIDED
    assert size_in_words("gyroscope", "bias-instability", 4.848e-6, 5e-7) == "1.00 °/h (0.83 to 1.25)".replace(
        " °", "\u202f°"
    )
