"""The findings so far explain one orthonormal span, and the residuals that remain are orthogonal to it."""

from dataclasses import replace

import numpy as np

from estimator.diagnosis.selection.search_state import SearchState
from estimator.diagnosis.signatures.noise import Autocorrelation, ExcessVariance
from tests.estimator.diagnosis.selection.small import SENSOR, candidate, effect, start

FEW = ("cubic-nonlinearity", "bias-ramp", "beta-eccentricity")


def found() -> SearchState:
    """Two causes found and one pattern."""
    state = start(FEW, effect("cubic-nonlinearity"))
    names = tuple(candidate(state, name) for name in FEW[:2])
    return replace(state, detections=names, structures=(candidate(state, "beta-eccentricity", ()),))


def test_findings_and_structures_span_as_many_directions_as_they_have_amplitudes() -> None:
    attributed = found().attributed()
    assert attributed.shape[1] == 1 + 1 + 2
    assert np.allclose(attributed.T @ attributed, np.eye(4))


def test_the_unit_of_an_amplitude_does_not_matter() -> None:
    state = found()
    small = tuple(replace(f, best=replace(f.best, trace=1e-8 * f.best.trace)) for f in state.detections)
    one, other = state.attributed(), replace(state, detections=small).attributed()
    assert np.allclose(one @ one.T, other @ other.T)


def test_one_finding_can_be_left_out() -> None:
    state = found()
    own = state.detections[0].best.trace[:, 0]
    rest = state.attributed(without=state.detections[0])
    assert rest.shape[1] == 3
    assert np.linalg.norm(own - rest @ (rest.T @ own)) > 0.1 * np.linalg.norm(own)


def test_the_same_trace_twice_is_one_direction() -> None:
    state = found()
    assert replace(state, detections=state.detections * 2).attributed().shape[1] == 4


def test_what_remains_is_orthogonal_to_every_finding() -> None:
    state = found()
    for f in (*state.detections, *state.structures):
        trace = f.best.trace / np.linalg.norm(f.best.trace, axis=0)
        assert np.abs(trace.T @ state.remaining).max() < 1e-6


def test_every_cause_that_the_session_can_show_is_put_to_the_test_and_so_is_noise() -> None:
    assert start(FEW).families == len(FEW) + 1


def test_scatter_is_attributed_to_noisy_and_to_autocorrelated_sensors() -> None:
    excess, course = ExcessVariance(0, 4.0, 19.0, 9.0, 1e-5), Autocorrelation(SENSOR, "temperature", 2.0)
    assert replace(start(FEW), excess=(excess,), autocorrelated=(course,)).scatter_attributed == {0, SENSOR}


def test_a_ranking_seen_from_a_sensor_holds_its_own_causes_and_the_common_ones() -> None:
    state = start(FEW)
    own, other, common = candidate(state, FEW[0]), candidate(state, FEW[0], (3,)), candidate(state, FEW[2], ())
    ranking = tuple((f.best, 0.0) for f in (own, other, common))
    assert [s.sensors for s, _ in replace(own, ranking=ranking).ranking_on((SENSOR,))] == [(SENSOR,), ()]
