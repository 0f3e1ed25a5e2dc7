"""Growth of noise in words."""

from dataclasses import replace

import numpy as np

from service.sessions.records import HistoryPoint
from service.sessions.words.noise import NOT_DECIDED, grown, size_in_words
from tests.service.pages.records import bias_point

SENSORS, FREEDOM = 6, 500.0


def records(rng: np.random.Generator, count: int, *, last: float = 1.0) -> list[HistoryPoint]:
    """White noise of size one, of six sensors in so many records, in the last another size."""
    found = []
    for number in range(count):
        for k, true in enumerate(np.full(SENSORS, last if number == count - 1 else 1.0)):
            value = float(true * np.sqrt(rng.chisquare(FREEDOM) / FREEDOM))
            size = {"value": value, "u": value / np.sqrt(2 * FREEDOM), "session": f"s{number}"}
            found.append(replace(bias_point(number, 1.0), sensor=f"A{k}", parameter="white-noise", **size))
    return found


def test_twice_the_noise_is_told_once_for_all_sensors() -> None:
    (sentence,) = grown(records(np.random.default_rng(2), 3, last=2.0))
    assert sentence.startswith("White noise N has grown in all accelerometers, ")


def test_a_single_sensor_is_named() -> None:
    points = records(np.random.default_rng(3), 3)
    last = points[-1]
    assert last.value is not None
    (sentence,) = grown([*points[:-1], replace(last, value=3 * last.value, u=3 * (last.u or 0.0))])
    assert sentence.startswith("White noise N of A5 has grown ")


def test_what_is_not_decided_is_no_number() -> None:
    assert size_in_words("gyroscope", "random-walk", None, None) == NOT_DECIDED
    assert size_in_words("gyroscope", "bias-instability", 4.848e-6, 5e-7) == "1.00 °/h (0.83 to 1.25)".replace(
        " °", "\u202f°"
    )
