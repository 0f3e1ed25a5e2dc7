"""Stated standard errors that the readings contradict, in a sentence."""

from math import nan

import pytest

from estimator.diagnosis.results import NoiseScale
from estimator.session import ACCELEROMETER, GYROSCOPE
from service.sessions.words.noise import but_wrong_errors, wrong_errors


@pytest.mark.parametrize(
    ("factor", "how"),
    [
        (4.14, "about 4 times too small"),
        (0.33, "about 3 times too large"),
        (1.42, "about 1.4 times too small"),
        (1.06, "about 1.06 times too small"),
        (0.0072, "about 140 times too large"),
        (0.0, "wrong by an unknown factor"),
        (nan, "wrong by an unknown factor"),
    ],
)
def test_how_far_off_they_are_is_said_in_times(factor: float, how: str) -> None:
    claim = NoiseScale(ACCELEROMETER, factor, 70.0)
    assert wrong_errors([claim], [ACCELEROMETER] * 4) == (f"The stated standard errors are {how}.",)


def test_a_session_of_both_kinds_says_whose() -> None:
    both = [NoiseScale(ACCELEROMETER, 4.0, 70.0), NoiseScale(GYROSCOPE, 0.5, 70.0)]
    assert wrong_errors(both, (ACCELEROMETER, GYROSCOPE)) == (
        "The stated standard errors of the accelerometers are about 4 times too small.",
        "The stated standard errors of the gyroscopes are about 2 times too large.",
    )


def test_right_ones_are_not_spoken_of() -> None:
    assert (wrong_errors([], [ACCELEROMETER]), but_wrong_errors([], [ACCELEROMETER])) == ((), "")


def test_wrong_ones_of_some_sensors_say_whose() -> None:
    some = [NoiseScale(ACCELEROMETER, 1 / 3, 70.0, who) for who in (("A2",), ("A1", "A3", "A4"))]
    assert wrong_errors(some, [ACCELEROMETER] * 6) == (
        "The stated standard errors of A2 are about 3 times too large.",
        "The stated standard errors of A1, A3 and A4 are about 3 times too large.",
    )
