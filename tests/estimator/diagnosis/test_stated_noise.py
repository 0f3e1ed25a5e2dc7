"""Stated noise is a claim that the readings test; a wrong one is said, and names no cause."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.study.other_noise import Hidden, Wish, beside_gyros, in_logs, in_orientations
from estimator import diagnose, read_session
from tests.blind.cases import draw_case
from tests.estimator.calibration.cases import accelerometers, block
from tests.estimator.causes.hiding import Scene
from tests.estimator.causes.physics import World
from tests.estimator.causes.worlds import truth_of, wandering
from tests.estimator.diagnosis.small import effect, measured, stated, swaying


@pytest.mark.parametrize("factor", [0.1, 1 / 3, 3.0])
def test_wrong_standard_errors_are_said_and_nothing_else(factor: float) -> None:
    found = diagnose(stated(measured(seed=3), factor))
    assert not found.findings
    assert not found.unexplained
    (scale,) = found.noise
    assert scale.factor == pytest.approx(1 / factor, rel=0.25)


@pytest.mark.slow
@pytest.mark.parametrize("factor", [0.1, 1 / 3, 3.0])
@pytest.mark.parametrize("identifier", ["bias-jump", "bias-ramp", "beta-second-harmonic"])
def test_a_cause_is_named_whatever_the_errors_are_stated_as(identifier: str, factor: float) -> None:
    found = diagnose(stated(measured(effect(identifier), 3), factor))
    assert [f.cause for f in found.findings] == [identifier]
    assert [scale.factor for scale in found.noise] == pytest.approx([1 / factor], rel=0.25)


@pytest.mark.parametrize("identifier", ["beta-second-harmonic", "stand-drift", "alpha-shift"])
def test_an_effect_that_all_sensors_show_is_no_noise(identifier: str) -> None:
    found = diagnose(measured(effect(identifier), 3))
    assert [f.cause for f in found.findings] == [identifier]
    assert found.noise == ()


@pytest.mark.parametrize("factor", [1 / 3, 3.0])
def test_in_orientations_too_where_no_sensor_by_itself_tells_its_noise(factor: float) -> None:
    """Eleven degrees of freedom a sensor: only all of them together tell the factor, the one that jumps among them."""
    found = diagnose(read_session(in_orientations(Wish("", hidden=True, seed=(5, 4, 1, 2)), factor).session))
    assert [(f.cause, f.sensors) for f in found.findings] == [("bias-jump", ("A5",))]
    assert [scale.factor for scale in found.noise] == pytest.approx([1 / factor], rel=0.25)


@pytest.mark.parametrize("world", [beside_gyros, in_logs])
@pytest.mark.parametrize("hidden", [False, True])
def test_a_jump_is_named_and_nothing_else_beside_gyros_and_in_rests_that_settle(
    world: Callable[[Wish], Hidden], hidden: bool
) -> None:
    found = diagnose(read_session(world(Wish("", hidden, seed=(5, 6, 1, 2))).session))
    assert [f.cause for f in found.findings] == ["bias-jump"] * hidden


def test_one_noisy_sensor_is_excess_noise_and_no_wrong_claim() -> None:
    found = diagnose(stated(measured(seed=3), 0.2, slice(1, 2)))
    assert [(f.cause, f.sensors) for f in found.findings] == [("excess-noise", ("A2",))]
    assert found.noise == ()


def test_some_sensors_of_too_large_errors_are_told_apart() -> None:
    """Half of them: the others' stated errors are believed."""
    found = diagnose(stated(measured(seed=3), 3.0, slice(0, 2)))
    assert not found.findings
    assert [(scale.sensors, scale.factor) for scale in found.noise] == [(("A1", "A2"), pytest.approx(1 / 3, rel=0.25))]


def test_sensors_of_too_small_errors_draw_no_other_in() -> None:
    """Believed too much, half of a block pulls what all share of a row to its own noise, which the others then show."""
    case = draw_case("none", (4001, 3, 1, 1, 0))
    session, earlier = (stated(read_session(file), 0.1, slice(0, 3)) for file in (case.session, *case.history))
    found = diagnose(session, history=[earlier])
    assert not found.findings
    assert [scale.sensors for scale in found.noise] == [("A1", "A2", "A3")]


@pytest.mark.parametrize("sensors", [slice(0, 1), slice(0, 2)])
def test_a_cause_is_named_on_a_sensor_whose_errors_are_stated_too_large(sensors: slice) -> None:
    """A2 jumps; it is one of those whose errors are wrong, or its own are right."""
    found = diagnose(stated(measured(effect("bias-jump"), 3), 3.0, sensors))
    assert [f.cause for f in found.findings] == ["bias-jump"]


@pytest.mark.parametrize("identifier", ["stand-drift", "alpha-shift"])
def test_what_is_common_is_named_beside_a_sensor_whose_errors_are_stated_too_small(identifier: str) -> None:
    """The sensor's noise, believed to be none, shows in all sensors and would pass for a course of the applied
    vector.
    """
    found = diagnose(stated(measured(effect(identifier), 3), 0.1, slice(1, 2)))
    assert {f.cause for f in found.findings} == {identifier, "excess-noise"}
    assert not found.unexplained


def repeated() -> Scene:
    """Four accelerometers, every position measured twice."""
    once = wandering(block(accelerometers(4), 12))
    twice = np.tile(np.arange(len(once.readings)), 2)
    schedule = replace(
        once,
        readings=once.readings[twice],
        standard_errors=once.standard_errors[twice],
        beta=once.beta[twice],
        flipped=once.flipped[twice],
        time=np.arange(len(twice)) * 300.0,
        temperature=once.temperature[twice],
        vibration=None,
    )
    return Scene(World(schedule, truth_of(schedule)), np.full(4, 3e-6))


@pytest.mark.slow
def test_a_course_of_the_applied_vector_is_no_wrong_claim() -> None:
    assert diagnose(measured(swaying(2e-4))).noise == ()
    assert diagnose(stated(measured(swaying(2e-4)), 0.3)).noise[0].factor == pytest.approx(1 / 0.3, rel=0.25)


def test_readings_without_noise_leave_the_diagnosis_standing() -> None:
    found = diagnose(stated(measured(seed=5), 1e6))
    assert not found.findings
    assert found.noise[0].factor < 1e-3


def test_repeats_that_contradict_the_stated_noise_do_not_save_it() -> None:
    found = diagnose(stated(repeated().measured(1), 0.2))
    assert not found.findings
    assert [scale.factor for scale in found.noise] == pytest.approx([5.0], rel=0.2)
