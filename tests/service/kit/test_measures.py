"""Numbers as people read them."""

import pytest

from service.kit.measures import deviation_measure, limit, measured, number, signed, size_in_words, value_measure

MICRO_G = deviation_measure("accelerometer", "bias", 1e-4)


def test_value_is_rounded_to_two_digits_of_its_uncertainty() -> None:
    assert measured(12.3456e-6 * 9.80665, 1.234e-6 * 9.80665, MICRO_G) == "12.3\u00a0±\u00a01.2\u202fµg"


def test_change_carries_its_sign() -> None:
    assert signed(2e-6 * 9.80665, None, MICRO_G) == "+2\u202fµg"
    assert signed(-2e-6 * 9.80665, None, MICRO_G) == "−2\u202fµg"


def test_large_deviations_change_to_the_coarse_unit() -> None:
    assert deviation_measure("accelerometer", "bias", 0.3).label == "mg"
    assert deviation_measure("gyroscope", "bias", 0.1).label == "°/s"
    assert deviation_measure("gyroscope", "bias", 1e-7).label == "°/h"


def test_one_g_squared_of_quadratic_is_its_bias_in_micro_g() -> None:
    quadratic = deviation_measure("accelerometer", "quadratic", 0.0)
    at_one_g = 3e-7 * 9.80665**2
    assert 3e-7 * quadratic.factor == pytest.approx(at_one_g * MICRO_G.factor)


def test_scale_is_read_per_g() -> None:
    unit = value_measure("accelerometer", "scale", 0.0)
    assert (unit.label, 0.12 * unit.factor) == ("per g", pytest.approx(1.176798))


@pytest.mark.parametrize(
    ("value", "written"),
    [
        (0.0, "0"),
        (100.0, "100"),
        (12345.6, "12\u202f346"),
        (-0.00012347, "−0.0001235"),
        (float("nan"), "–"),
        (None, "–"),
    ],
)
def test_plain_numbers(value: float | None, written: str) -> None:
    assert number(value) == written


def test_zero_after_rounding_has_no_sign() -> None:
    assert number(-0.0004, 2) == "0.00"


def test_tolerance_of_an_angle_is_one_sided() -> None:
    assert limit(4e-4, MICRO_G, one_sided=False).startswith("±40.79")
    assert limit(4e-4, MICRO_G, one_sided=True).startswith("40.79")


def test_sizes_in_words() -> None:
    assert [size_in_words(n) for n in (12, 12_345, 3_400_000)] == ["12 bytes", "12.3\u202fkB", "3.4\u202fMB"]
