"""Forward selection adds causes one after another, and looks at scatter before it calls it noise."""

from dataclasses import replace

import numpy as np
import pytest

from estimator.diagnosis.selection.excess_noise import largest_excess, with_unknown_noise
from estimator.diagnosis.selection.forward import (
    MOST,
    forward_selection,
    holds_pattern,
    log_evidence_of_two,
    repeated_too_often,
    scatter_or_cause,
    with_structures,
)
from estimator.diagnosis.selection.ranking import strongest
from estimator.diagnosis.signatures.noise import Autocorrelation
from tests.estimator.diagnosis.selection.small import BETA, ROWS, SENSOR, candidate, effect, names, on_sensor, start

FEW = ("cubic-nonlinearity", "bias-ramp", "beta-eccentricity")
CUBIC = effect("cubic-nonlinearity")
NOISE = on_sensor(6 * np.random.default_rng(3).standard_normal(ROWS))
WALK = on_sensor(14 * np.cumsum(np.random.default_rng(0).standard_normal(ROWS)))
HARMONIC = on_sensor(20 * np.sin(4 * BETA + 0.3))
JUMPS = on_sensor(sum(size * (np.arange(ROWS) >= row) for size, row in ((40.0, 4), (30.0, 10), (20.0, 18))))


def test_nothing_is_found_in_a_sound_session() -> None:
    assert names(forward_selection(start(FEW))) == []


def test_causes_are_added_until_none_is_significant() -> None:
    state = forward_selection(start(FEW, CUBIC + effect("beta-eccentricity")))
    assert names(state) == [("beta-eccentricity", ()), ("cubic-nonlinearity", (SENSOR,))]
    assert strongest(state, state.traces) is None


def test_the_same_cause_is_found_on_every_sensor_that_shows_it() -> None:
    state = forward_selection(start(FEW, CUBIC + effect("cubic-nonlinearity", 3)))
    assert names(state) == [("cubic-nonlinearity", (1,)), ("cubic-nonlinearity", (3,))]


def test_scatter_above_the_stated_noise_is_noise_and_the_search_begins_anew_with_it() -> None:
    before, state = start(FEW, NOISE), forward_selection(start(FEW, NOISE))
    (excess,) = state.excess
    assert (excess.sensor, names(state)) == (SENSOR, [])
    assert state.baseline.unstated.tolist() == [False, True, False, False]
    ratio = state.baseline.variance / before.baseline.variance
    assert np.allclose(ratio[0], [1, excess.ratio, 1, 1])


def test_a_cause_beside_noise_is_found() -> None:
    state = forward_selection(start(FEW, NOISE + effect("cubic-nonlinearity", 2)))
    assert names(state) == [("cubic-nonlinearity", (2,))]
    assert [e.sensor for e in state.excess] == [SENSOR]


def test_scatter_that_wanders_is_no_noise_and_gets_no_name() -> None:
    state = forward_selection(start((*FEW, "bias-jump"), WALK))
    (course,) = state.autocorrelated
    assert (course.sensor, course.plain) == (SENSOR, True)
    assert (names(state), state.excess) == ([], ())


def test_scatter_that_holds_a_pattern_is_no_noise() -> None:
    state = start(FEW, HARMONIC)
    noisy = largest_excess(state)
    assert noisy is not None
    assert holds_pattern(state, with_unknown_noise(state, SENSOR), noisy)
    assert forward_selection(state).excess == ()


def test_noise_holds_no_pattern() -> None:
    state = start(FEW, NOISE)
    noisy = largest_excess(state)
    assert noisy is not None
    assert not holds_pattern(state, with_unknown_noise(state, SENSOR), noisy)


def test_a_course_likelier_than_the_cause_that_stands_out_of_it_gets_no_name() -> None:
    state = start(("bias-jump", "bias-ramp"), on_sensor(np.repeat([0.0, 20, 60, 90, 70, 100], 4)))
    noisy, doubting = largest_excess(state), with_unknown_noise(state, SENSOR)
    assert noisy is not None
    assert strongest(doubting, doubting.traces) is not None
    (course,), best = scatter_or_cause(state, noisy)
    assert isinstance(course, Autocorrelation)
    assert best is None


def test_a_cause_likelier_than_a_course_is_named() -> None:
    state = start(("bias-ramp",), effect("bias-ramp") + on_sensor(4 * np.random.default_rng(3).standard_normal(ROWS)))
    noisy = largest_excess(state)
    assert noisy is not None
    scatter, best = scatter_or_cause(state, noisy)
    assert scatter == ()
    assert best is not None
    assert best.best.group == ("bias-ramp", (SENSOR,))


def test_a_cause_named_more_often_than_it_can_act_is_too_often() -> None:
    found = candidate(start(("bias-jump",), JUMPS), "bias-jump")
    assert repeated_too_often([found] * 2) == frozenset()
    assert repeated_too_often([found] * 3) == {("bias-jump", (SENSOR,))}


def test_a_cause_named_too_often_is_refuted_and_the_others_stay() -> None:
    state = start(("bias-jump", "cubic-nonlinearity"), JUMPS + effect("cubic-nonlinearity", 2))
    for _ in range(2):
        state = replace(state, detections=(*state.detections, candidate(state, "bias-jump")))
    state = forward_selection(state)
    assert state.refuted == {("bias-jump", (SENSOR,))}
    assert names(state) == [("cubic-nonlinearity", (2,))]


def test_a_cause_that_acts_once_is_not_named_twice_on_a_sensor() -> None:
    state = start(FEW, CUBIC)
    found = candidate(state, "cubic-nonlinearity")
    elsewhere = replace(found, best=replace(found.best, trace=candidate(state, "bias-ramp", (3,)).best.trace))
    state = forward_selection(replace(state, detections=(elsewhere,)))
    assert (state.detections, state.refuted) == ((elsewhere,), frozenset())


def test_a_second_cause_counts_in_the_evidence_of_two() -> None:
    state = start(FEW, CUBIC + effect("bias-ramp", 3))
    doubting = with_unknown_noise(state, SENSOR)
    first = strongest(doubting, doubting.traces)
    assert first is not None
    assert log_evidence_of_two(doubting, first) > first.cause_log_evidence + 10


def test_without_a_second_cause_the_evidence_is_that_of_the_first() -> None:
    state = start(FEW, CUBIC)
    first = strongest(state, state.traces)
    assert first is not None
    assert log_evidence_of_two(state, first) == pytest.approx(first.best.log_evidence)


def test_patterns_are_added_until_none_is_significant() -> None:
    state = with_structures(start(FEW, HARMONIC))
    assert [s.best.sensors for s in state.structures] == [(SENSOR,)]
    assert strongest(state, state.patterns) is None


def test_a_sound_session_holds_no_pattern() -> None:
    assert with_structures(start(FEW)).structures == ()


def test_the_search_ends_though_patterns_go_on() -> None:
    spikes = on_sensor(200 * np.random.default_rng(1).standard_cauchy(ROWS))
    assert len({s.best.group for s in with_structures(start((), spikes)).structures}) <= MOST
