"""Identification by a set of still orientations before it is flown: 13 parameters of four accelerometers."""

from dataclasses import replace

import numpy as np
import pytest

from estimator import ScheduleError, calibrate
from estimator.planning import proposed_orientations, rank_of_orientations
from estimator.session import Array
from estimator.simulate import orientation_schedule, scattered, simulate
from tests.builders import GRAVITY
from tests.estimator.calibration.cases import SITE, accelerometers, gyros, sphere

FOUR = accelerometers(4)


def in_two_planes(count: int) -> Array:
    """(2 count, 3) unit vectors, dimensionless, of turns that stay in XZ and YZ."""
    t = 2 * np.pi * np.arange(count) / count
    zero = np.zeros(count)
    return np.concatenate([np.stack([np.sin(t), zero, np.cos(t)], -1), np.stack([zero, np.sin(t), np.cos(t)], -1)])


@pytest.mark.parametrize(("m", "full"), [(3, 9), (4, 13), (6, 21)])
def test_nine_generic_orientations_are_needed_whatever_the_number_of_sensors(m: int, full: int) -> None:
    ranks = [rank_of_orientations(accelerometers(m), sphere(R)).rank for R in (7, 8, 9, 12)]
    assert ranks == [full - 2, full - 1, full, full]


@pytest.mark.parametrize("count", [8, 24, 100])
def test_turns_in_two_planes_leave_one_direction_open_for_ever(count: int) -> None:
    found = rank_of_orientations(FOUR, in_two_planes(count))
    assert (found.rank, found.parameters) == (12, 13)
    assert not found.full
    (open_direction,) = found.unseen
    assert "axis" in open_direction


@pytest.mark.parametrize("directions", [in_two_planes(8), sphere(6), np.eye(3)], ids=["planes", "six", "three"])
def test_what_is_proposed_completes_the_set(directions: Array) -> None:
    found = rank_of_orientations(FOUR, directions)
    assert len(found.add)
    assert rank_of_orientations(FOUR, np.concatenate([directions, found.add])).full


def test_two_planes_need_one_orientation_that_shows_x_and_y_together() -> None:
    (x, y, _) = rank_of_orientations(FOUR, in_two_planes(8)).add[0]
    assert abs(x * y) > 0.3


def test_nine_orientations_chosen_from_scratch_identify_everything() -> None:
    directions = proposed_orientations(FOUR)
    found = rank_of_orientations(FOUR, directions)
    assert len(directions) == 9
    assert found.full
    assert len(found.add) == 0
    random = [rank_of_orientations(FOUR, d).weakest[1] for d in np.split(sphere(90), 10)]
    assert found.weakest[1] < min(random)


def test_expected_sigmas_are_those_of_a_simulated_calibration() -> None:
    directions = proposed_orientations(FOUR, 12)
    expected = rank_of_orientations(FOUR, directions, noise=1e-5).sigma.reshape(4, 5)
    sensors = tuple(replace(s, bias_repeatability=0.0) for s in FOUR)
    truth = scattered(
        sensors, np.full(4, GRAVITY), np.random.default_rng(0), scale=1e-5, bias=1e-5, quadratic=0, axis=1e-5
    )
    session = simulate(
        orientation_schedule(sensors, SITE, directions), truth, np.random.default_rng(1), noise=1e-5 * GRAVITY * 0.12
    )
    found = calibrate(session, quadratic=False)
    for row, sensor in zip(expected, found.sensors, strict=True):
        assert sensor.scale.sigma / sensor.scale.value == pytest.approx(row[0], rel=0.02)
        assert sensor.bias.sigma / GRAVITY == pytest.approx(row[1], rel=0.02)
        assert sensor.axis_sigma == pytest.approx(np.hypot(row[3], row[4]), rel=0.02)


def test_a_degree_of_error_in_the_table_does_not_matter() -> None:
    directions = proposed_orientations(FOUR, 12)
    astray = directions + np.radians(1.0) * np.random.default_rng(3).standard_normal(directions.shape)
    exact, rough = (rank_of_orientations(FOUR, d) for d in (directions, astray))
    assert rough.full
    assert rough.weakest[1] == pytest.approx(exact.weakest[1], rel=0.1)


def test_stated_directions_tell_the_common_turn_too() -> None:
    found = rank_of_orientations(FOUR, sphere(12), direction_sigma=1e-3)
    assert found.parameters == 16
    assert found.full


def test_second_order_terms_ask_for_more_orientations() -> None:
    directions = proposed_orientations(FOUR)
    assert not rank_of_orientations(FOUR, directions, quadratic=True).full
    more = proposed_orientations(FOUR, quadratic=True)
    assert rank_of_orientations(FOUR, more, quadratic=True).full


def test_gyros_take_no_part_and_alone_they_are_refused() -> None:
    assert rank_of_orientations((*FOUR, *gyros(3)), sphere(9)).parameters == 13
    with pytest.raises(ScheduleError, match="three or more accelerometers"):
        rank_of_orientations(gyros(6), sphere(9))


@pytest.mark.parametrize("directions", [np.zeros((0, 3)), np.zeros((1, 3)), np.array([[np.nan, 0, 1]])])
def test_directions_that_are_none_are_refused(directions: Array) -> None:
    with pytest.raises(ScheduleError, match="directions"):
        rank_of_orientations(FOUR, directions)


def test_the_rank_is_a_document() -> None:
    document = rank_of_orientations(FOUR, in_two_planes(8)).to_dict()
    assert document["full"] is False
    assert document["sigma"]["A1.quadratic"] is None
    assert len(document["add"]) == 1
