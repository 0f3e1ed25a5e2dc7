"""A board that warms is one finding of all that warm and of nobody else; what each has to itself is not shared."""

import numpy as np
import pytest

from estimator import diagnose, read_session
from estimator.diagnosis import Finding
from tests.blind.courses import BLOCKS, Driven, draw_apart, draw_course, draw_departing, draw_settling_at
from tests.blind.steps import WALKS, draw_others

STAND, GYROS, TWELVE, MANY = BLOCKS
KNOWN = {"exponential": "warm-up", "step": "bias-jump", "ramp": "bias-ramp", "room": "shared-course"}


def found_in(hidden: Driven) -> tuple[Finding, ...]:
    """Findings of the diagnosis."""
    return diagnose(read_session(hidden.session)).findings


@pytest.mark.parametrize(
    ("block", "course", "count", "strength", "seed"),
    [
        pytest.param(0, "exponential", 6, 20.0, 1, id="all 6 on a stand settle"),
        pytest.param(0, "exponential", 3, 30.0, 2, id="3 of 6 on a stand settle"),
        pytest.param(1, "exponential", 6, 20.0, 3, id="6 gyros settle"),
        pytest.param(2, "exponential", 7, 30.0, 4, id="7 of 12 in orientations settle"),
        pytest.param(0, "ramp", 5, 24.0, 6, id="5 of 6 drift"),
        pytest.param(0, "step", 6, 24.0, 7, id="all 6 step"),
        pytest.param(0, "room", 6, 30.0, 9, id="all 6 follow a room that nobody recorded"),
    ],
)
def test_what_sensors_share_is_one_finding_of_these_sensors(
    block: int, course: str, count: int, strength: float, seed: int
) -> None:
    hidden = draw_course(BLOCKS[block], course, count, strength, np.random.default_rng((51, seed)))
    (found,) = found_in(hidden)
    assert found.shared is not None
    assert found.cause == KNOWN[course]
    assert set(found.sensors) <= set(hidden.sensors)
    plain = {name for name, strength in zip(hidden.sensors, hidden.strength, strict=True) if strength > 6}
    assert plain <= {*found.sensors, *found.shared.more}


def test_a_time_constant_and_every_size_lie_within_their_uncertainty() -> None:
    hidden = draw_course(STAND, "exponential", 6, 40.0, np.random.default_rng((52, 1)), even=True)
    (found,) = found_in(hidden)
    assert found.shared is not None
    assert abs(found.shared.shape["s"] - hidden.shape) < 3 * found.shared.shape_sigma["s"]
    assert not found.shared.shape_in_doubt
    true = dict(zip(hidden.sensors, hidden.size, strict=True))
    for name, value, sigma in zip(found.sensors, found.amplitude, found.sigma, strict=True):
        assert abs(value - true[name]) < 4 * sigma


@pytest.mark.slow
def test_many_that_none_can_be_named_alone_are_found_together() -> None:
    hidden = draw_course(MANY, "exponential", 24, 14.0, np.random.default_rng((53, 1)), even=True)
    (found,) = found_in(hidden)
    assert found.shared is not None
    assert found.cause == "warm-up"
    assert len(found.sensors) + len(found.shared.more) >= 20


def test_one_sensor_that_settles_is_named_alone() -> None:
    hidden = draw_course(STAND, "exponential", 1, 20.0, np.random.default_rng((54, 1)))
    (found,) = found_in(hidden)
    assert (found.cause, found.sensors, found.shared) == ("warm-up", hidden.sensors, None)


def test_time_constants_that_differ_clearly_are_not_one() -> None:
    hidden = draw_settling_at(STAND, np.array([0.06, 0.5]), 40.0, np.random.default_rng((55, 1)))
    found = found_in(hidden)
    assert all(f.shared is None for f in found)
    constants = [shape["s"] for f in found for shape in f.nonlinear_each if f.cause == "warm-up"]
    assert len(constants) == 2
    assert max(constants) > 3 * min(constants)


def test_time_constants_that_differ_little_are_one_in_doubt() -> None:
    hidden = draw_settling_at(STAND, np.array([0.16, 0.2, 0.25]), 10.0, np.random.default_rng((55, 2)))
    (found,) = found_in(hidden)
    assert found.shared is not None
    assert found.shared.shape_in_doubt


@pytest.mark.parametrize("block", [0, 2])
@pytest.mark.parametrize("seed", range(3))
def test_a_sound_session_shows_no_course(block: int, seed: int) -> None:
    hidden = draw_course(BLOCKS[block], "ramp", 1, 0.0, np.random.default_rng((56, block, seed)))
    assert found_in(hidden) == ()


@pytest.mark.slow
def test_zeros_that_wander_each_by_itself_share_nothing() -> None:
    walking = draw_others(STAND, WALKS, 12.0, np.random.default_rng((57, 0)))
    assert all(f.shared is None for f in diagnose(read_session(walking.session)).findings)
    roaming = draw_apart(TWELVE, "room", 6, 12.0, np.random.default_rng((58, 2)))
    assert all(f.shared is None for f in found_in(roaming))


@pytest.mark.slow
def test_sensors_that_depart_from_a_course_hide_it_no_more_than_they_spoil_the_others() -> None:
    hidden = draw_departing(MANY, 4, 15.0, np.random.default_rng((77, 24, 4, 8, 0)), second=False)
    found = diagnose(read_session(hidden.session))
    shared, *others = found.findings
    assert shared.shared is not None
    assert {name for other in others for name in other.sensors} <= set(hidden.sensors)
    assert found.gain.after.chi2_per_dof < 1.21 < found.gain.before.chi2_per_dof
