"""Backward elimination takes back what loses its significance or is explained otherwise."""

from dataclasses import replace

import numpy as np
import pytest

from estimator.diagnosis.selection.backward import (
    backward_elimination,
    without_names_on_courses,
    without_needless_drift,
)
from estimator.diagnosis.selection.search_state import SearchState
from estimator.diagnosis.signatures.noise import Autocorrelation, ExcessVariance
from tests.estimator.diagnosis.selection.small import (
    ROWS,
    SENSOR,
    candidate,
    effect,
    measured,
    names,
    on_sensor,
    start,
)

WALK = on_sensor(14 * np.cumsum(np.random.default_rng(0).standard_normal(ROWS)))
WARMTH = effect("bias-temperature")


def selected(state: SearchState, *identifiers: str) -> SearchState:
    """The search as if these causes had been selected one after another."""
    for identifier in identifiers:
        state = replace(state, detections=(*state.detections, candidate(state, identifier)))
    return state


def test_what_is_not_significant_beside_the_rest_goes() -> None:
    state = start(("cubic-nonlinearity", "bias-ramp"), effect("cubic-nonlinearity"))
    left = backward_elimination(selected(state, "cubic-nonlinearity", "bias-ramp"))
    assert names(left) == [("cubic-nonlinearity", (SENSOR,))]


def test_the_weakest_of_two_that_explain_the_same_goes_first() -> None:
    state = start(("odd-quadratic", "cubic-nonlinearity", "bias-ramp"), effect("cubic-nonlinearity"))
    left = backward_elimination(selected(state, "cubic-nonlinearity", "odd-quadratic"))
    assert len(left.detections) == 1


def test_what_is_significant_beside_the_rest_stays() -> None:
    state = start(("cubic-nonlinearity", "bias-ramp"), effect("cubic-nonlinearity") + effect("bias-ramp"))
    both = selected(state, "cubic-nonlinearity", "bias-ramp")
    assert backward_elimination(both).detections == both.detections


def since_half_the_history() -> SearchState:
    """A sensor that follows the temperature now and did so in one of two earlier sessions."""
    history = (measured(WARMTH, 11), measured(0.0, 12))
    return start(("sensor-drift", "bias-temperature"), WARMTH, history)


def test_drift_that_another_effect_on_the_sensor_explains_is_taken_back() -> None:
    state = selected(since_half_the_history(), "sensor-drift", "bias-temperature")
    assert names(without_needless_drift(state)) == [("bias-temperature", (SENSOR,))]


def test_drift_without_another_effect_on_the_sensor_stays() -> None:
    moved = on_sensor(np.full(ROWS, 40.0))
    state = start(("sensor-drift", "bias-temperature"), moved, (measured(0.0, 11), measured(0.0, 12)))
    alone = selected(state, "sensor-drift")
    assert without_needless_drift(alone).detections == alone.detections


def test_drift_of_another_sensor_stays() -> None:
    history = (measured(WARMTH, 11), measured(0.0, 12))
    state = start(("sensor-drift", "bias-temperature"), WARMTH + on_sensor(np.full(ROWS, 40.0), 3), history)
    state = replace(state, detections=(candidate(state, "sensor-drift", (3,)),))
    both = selected(state, "bias-temperature")
    assert without_needless_drift(both).detections == both.detections


def test_names_that_patch_up_a_course_are_withdrawn() -> None:
    state = selected(start(("bias-jump", "reading-outlier"), WALK), "bias-jump", "reading-outlier")
    left = without_names_on_courses(state)
    assert names(left) == []
    assert [a.sensor for a in left.autocorrelated] == [SENSOR]


def test_two_true_causes_of_one_sensor_stay() -> None:
    state = start(("bias-jump", "reading-outlier"), effect("bias-jump") + effect("reading-outlier"))
    both = selected(state, "bias-jump", "reading-outlier")
    assert names(without_names_on_courses(both)) == names(both)


def test_a_single_name_that_a_course_explains_better_goes() -> None:
    alone = selected(start(("bias-jump",), WALK), "bias-jump")
    assert names(without_names_on_courses(alone)) == []


def test_a_course_beside_a_name_that_it_does_not_beat_is_hardly_likely() -> None:
    alone = selected(start(("bias-jump",), effect("bias-jump")), "bias-jump")
    (kept,) = without_names_on_courses(alone).detections
    assert 0 < kept.unnamed < 0.005


@pytest.mark.parametrize("sensor", [0, 3])
def test_a_course_on_one_sensor_leaves_the_names_of_others(sensor: int) -> None:
    state = start(("bias-jump", "reading-outlier", "bias-ramp"), WALK + effect("bias-ramp", sensor))
    state = selected(state, "bias-jump", "reading-outlier")
    state = replace(state, detections=(*state.detections, candidate(state, "bias-ramp", (sensor,))))
    assert names(without_names_on_courses(state)) == [("bias-ramp", (sensor,))]


def test_a_course_takes_over_the_excess_of_its_sensor_and_leaves_that_of_others() -> None:
    own, other = (ExcessVariance(sensor, 9.0, 19.0, 50.0, 1e-20) for sensor in (SENSOR, 3))
    state = replace(selected(start(("bias-jump",), WALK), "bias-jump"), excess=(own, other))
    elsewhere = Autocorrelation(0, "temperature", 2.0)
    left = without_names_on_courses(replace(state, autocorrelated=(elsewhere,)))
    assert names(left) == []
    assert left.excess == (other,)
    assert [(a.sensor, a.ratio, a.excess_log_evidence) for a in left.autocorrelated] == [
        (0, 1.0, 0.0),
        (SENSOR, 9.0, 50.0),
    ]
