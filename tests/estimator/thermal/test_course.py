"""The course of temperature: levels, curves, legs, lags."""

import numpy as np
import pytest

from estimator.errors import ScheduleError
from estimator.session import Array
from estimator.thermal.course import TemperatureCourse, course_of, levels_of
from tests.estimator.thermal.physics import SOAKS, Still, behind, lived
from tests.estimator.thermal.sessions import session_of


def course(*celsius: float, seconds: Array | None = None) -> TemperatureCourse:
    T = np.array(celsius)
    return TemperatureCourse(T, seconds, levels_of(T))


@pytest.mark.parametrize(
    ("ends", "reference"),
    [((-40, 70), 20), ((20, 70), 20), ((-40, 20), 20), ((30, 71), 50), ((-40, 10), -15)],
)
def test_the_reference_is_twenty_degrees_where_they_were_seen_else_the_middle(
    ends: tuple[float, float], reference: float
) -> None:
    assert course(*ends).reference == reference


def test_temperatures_two_degrees_apart_are_one_level() -> None:
    assert levels_of(np.array([0.0, 2.0, 1.0, 2.1, 4.1, 4.2, 4.1])) == 3
    assert levels_of(np.array([5.0])) == 1


@pytest.mark.parametrize(("levels", "order"), [(2, 1), (3, 1), (4, 2), (5, 3), (6, 4), (9, 4)])
def test_a_polynomial_leaves_a_level_to_judge_it_by(levels: int, order: int) -> None:
    assert course(*10.0 * np.arange(levels)).order == order


def test_legendre_polynomials_are_orthogonal_over_the_range() -> None:
    T = np.linspace(-40, 70, 20001)
    basis = course(*T).basis(3)
    assert basis.shape == (20001, 4)
    assert basis[0] == pytest.approx([1, -1, 1, -1])
    assert basis[-1] == pytest.approx([1, 1, 1, 1])
    assert basis.T @ basis / len(T) == pytest.approx(np.diag([1, 1 / 3, 1 / 5, 1 / 7]), abs=3e-4)


@pytest.mark.parametrize("order", [1, 3])
def test_a_curve_is_the_same_in_powers_of_the_distance_from_the_reference(order: int) -> None:
    one = course(-40.0, -3.0, 11.0, 52.0, 90.0)
    legendre = np.arange(1.0, order + 2)
    powers = one.to_powers(order) @ legendre
    assert np.vander(one.temperature - 20, order + 1, increasing=True) @ powers == pytest.approx(
        one.basis(order) @ legendre
    )


def test_legs_begin_with_the_first_move_and_end_where_the_temperature_returns() -> None:
    """5 % of 100 °C must be gone."""
    celsius = (20, 24, 25.5, 90, 100, 96, 94.5, 50, 0, 4.9, 5.1, 5.2)
    assert course(*celsius).leg.tolist() == [0, 0, 1, 1, 1, 1, -1, -1, -1, -1, 1, 1]
    assert course(20, 16, 14.5, 0, 100).leg.tolist() == [0, 0, -1, -1, 1]


def test_in_a_small_range_two_degrees_must_be_gone() -> None:
    assert course(20, 21.9, 20, 22.1, 30, 28.1, 30, 27.9).leg.tolist() == [0, 0, 0, 1, 1, 1, 1, -1]


def test_where_the_temperature_turns_by_just_what_is_noise_the_leg_goes_on() -> None:
    assert course(0, 100, 95, 94.9).leg.tolist() == [0, 1, 1, -1]
    assert course(0, 5, 100).leg.tolist() == [0, 0, 1]


def test_a_loop_is_one_wide_in_the_middle_and_closed_at_its_ends() -> None:
    loop = course(0, 50, 100, 50, 0, 25).loop
    assert loop[1] - loop[3] == pytest.approx(1.0)
    assert loop[[0, 2, 4]] == pytest.approx(0.0)
    assert loop[5] == pytest.approx((1 - 0.5**2) / 2)


def test_lags_are_looked_for_from_the_spacing_of_rows_to_a_sixteenth_of_the_time() -> None:
    T = np.linspace(0, 50, 101)
    found = course(*T, seconds=1600.0 + 16.0 * np.arange(101)).time_constants
    assert found[0] == pytest.approx(1600 / 101)
    assert found[-1] == pytest.approx(100)
    assert len(found) == 8
    assert found[1:] / found[:-1] == pytest.approx(found[1] / found[0])
    few = course(0, 50, seconds=np.array([0.0, 640.0])).time_constants
    assert (few[0], few[-1]) == pytest.approx((10, 40))


def test_without_times_no_lag_is_looked_for() -> None:
    assert len(course(0, 50).time_constants) == 0
    assert len(course(0, 50, seconds=np.zeros(2)).time_constants) == 0
    assert len(course(0, 50, seconds=np.array([0.0, 0.1])).time_constants) == 8


def test_what_lags_is_behind_as_a_body_of_one_heat_capacity() -> None:
    time = np.linspace(0, 6000, 61)
    T = np.interp(time, [0, 2000, 4000, 6000], [20.0, 60.0, 60.0, 0.0])
    assert course(*T, seconds=time).behind(500.0) == pytest.approx(behind(T, time, 500.0), abs=0.02)


def test_a_session_needs_temperatures_over_ten_degrees() -> None:
    rng = np.random.default_rng(1)
    flat = lived(Still(soaks=tuple(0.5 * c / 9 for c in SOAKS)), rng)[0]
    with pytest.raises(ScheduleError, match=r"needs 10 °C or more"):
        course_of(session_of(flat))
    flat["table"]["temperature_c"] = np.linspace(20, 30, 81).tolist()
    assert course_of(session_of(flat)).levels == 5
    del flat["table"]["temperature_c"]
    with pytest.raises(ValueError, match="temperature_c"):
        session_of(flat)
