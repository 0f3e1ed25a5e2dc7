"""The sentence names sensor, parameter, numbers and what to do, in people's units."""

from dataclasses import replace

import pytest

from estimator.applied_vector import STANDARD_GRAVITY
from service.judging.words import reason
from service.kit.measures import in_words
from service.sessions.decision import Decision, Verdict, worst_of

MICRO_G = 1e-6 * STANDARD_GRAVITY
BIAS = Decision(
    sensor="A3", kind="accelerometer", parameter="bias", value=0.0, reference=0.0, deviation=62 * MICRO_G,
    uncertainty=4 * MICRO_G, expanded=8 * MICRO_G, coverage_factor=2.0, tolerance=50 * MICRO_G,
    probability_out=1.0, verdict=Verdict.FAIL, rule="r", critical=14 * MICRO_G,
)  # fmt: skip


def test_a_failure_names_sensor_parameter_change_uncertainty_and_tolerance() -> None:
    assert reason((BIAS,)) == "A3 bias changed by +62 µg (U 8.0 µg), beyond the tolerance of ±50 µg."


def test_the_worst_verdict_comes_first_and_then_the_least_margin() -> None:
    passing = replace(BIAS, sensor="A1", deviation=0.0, verdict=Verdict.PASS)
    better = replace(BIAS, sensor="A2", deviation=-60 * MICRO_G)
    assert reason((passing, better, BIAS)).startswith("A3")
    assert worst_of((passing, better, BIAS)) is BIAS


def test_a_margin_is_one_when_spotless_and_negative_beyond() -> None:
    assert replace(BIAS, deviation=0.0, expanded=0.0).margin == 1
    assert BIAS.margin == pytest.approx(1 - 70 / 50)
    assert replace(BIAS, deviation=None).margin is None


def test_what_is_not_observed_names_every_sensor_and_says_what_to_do() -> None:
    unseen = replace(BIAS, value=None, deviation=None, expanded=None, verdict=Verdict.UNDECIDABLE)
    text = reason((unseen, replace(unseen, sensor="A4")))
    assert text == "Bias of A3, A4 is not observable in this session: add positions."


def test_too_coarse_a_measurement_says_so() -> None:
    coarse = replace(BIAS, expanded=80 * MICRO_G, verdict=Verdict.UNDECIDABLE)
    assert "has U 80 µg, more than its tolerance of ±50 µg" in reason((coarse,))


def test_a_pass_names_what_is_closest_to_its_tolerance() -> None:
    good = replace(BIAS, deviation=-3 * MICRO_G, verdict=Verdict.PASS)
    assert reason((good,)).endswith("closest to it: A3 bias, changed by −3.0 µg (U 8.0 µg), tolerance ±50 µg.")


@pytest.mark.parametrize(
    ("kind", "parameter", "si", "expected"),
    [
        ("accelerometer", "scale", 1e-4, "100 ppm"),
        ("accelerometer", "quadratic", 20e-6 / STANDARD_GRAVITY, "20 µg/g²"),
        ("accelerometer", "axis", 9.69627e-5, "20 arcsec"),
        ("gyroscope", "bias", 2.42407e-7, "0.050 °/h"),
    ],
)
def test_people_s_units(kind: str, parameter: str, si: float, expected: str) -> None:
    assert in_words(kind, parameter, si) == expected
