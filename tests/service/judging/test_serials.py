"""Serial numbers that are slips of writing, and those that are the next units of a fleet."""

import pytest

from service.demo.cast import CAST
from service.judging.origin import folded, is_one_keystroke, is_slip

FLEET = [f"BA-{k}" for k in range(101, 131)]


@pytest.mark.parametrize(
    "written", ["ba-101", "BA-1O1", "BA-10l", "BA-I01", "B\u0410-101", "\u0412\u0410-101", "BA\u2013101", "BA- 101"]
)
def test_what_looks_alike_is_one_name(written: str) -> None:
    assert folded(written) == folded("BA-101")


def test_two_encodings_of_a_letter_are_one_name() -> None:
    assert folded("Gera\u0308t 7") == folded("Ger\u00e4t 7")


def asked_of(new: str, fleet: list[str]) -> bool:
    """Whether a new unit is taken for one of a fleet by its spelling."""
    return any(folded(new) == folded(one) or (is_one_keystroke(new, one) and is_slip(new, one, fleet)) for one in fleet)


@pytest.mark.parametrize("new", ["BA101", "BB-101", "AB-101", "BA-10X", "BA-101A", "BA-1011", "BA-10", "BA-0101"])
def test_a_keystroke_that_leaves_the_series_is_a_slip(new: str) -> None:
    assert asked_of(new, FLEET)


@pytest.mark.parametrize("order", [1, -1, 7])
@pytest.mark.parametrize("name", ["BA-{}", "{}", "IMU {:04d}/A", "{:03d}", "SN{}L"])
@pytest.mark.parametrize("first", [1, 85, 101])
def test_no_unit_of_a_numbered_fleet_is_taken_for_another(name: str, first: int, order: int) -> None:
    numbers = sorted(range(first, first + 30), key=lambda k: k * order % 31)
    fleet = [name.format(k) for k in numbers]
    assert [one for i, one in enumerate(fleet) if asked_of(one, fleet[:i])] == []


def test_letters_that_tell_units_apart_ask_once() -> None:
    fleet = [f"BA-10{k}{side}" for k in range(5) for side in "LR"]
    assert [one for i, one in enumerate(fleet) if asked_of(one, fleet[:i])] == ["BA-100R"]


def test_nobody_of_the_demonstration_is_taken_for_another() -> None:
    serials = [member.serial for member in CAST]
    assert [one for i, one in enumerate(serials) if asked_of(one, serials[:i])] == []
