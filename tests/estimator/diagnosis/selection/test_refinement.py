"""Continuous shape parameters are refined between the points of their grid, and cost amplitude precision."""

from dataclasses import replace

import numpy as np
import pytest

from estimator.diagnosis.explanation.extended_model import amplitudes
from estimator.diagnosis.selection.refinement import with_refined_shapes
from estimator.diagnosis.selection.search_state import SearchState
from tests.estimator.diagnosis.selection.small import (
    ROWS,
    SENSOR,
    TIME,
    candidate,
    effect,
    measured,
    on_sensor,
    start,
)

TAU = float(np.ptp(TIME)) / ROWS ** (8.5 / 9)
"""s, midway between two points of the grid."""
WARM = on_sensor(2000 * np.exp(-TIME / TAU))


def grown(history: tuple[float, ...] = ()) -> SearchState:
    """The search with the warm-up at its best grid point; earlier sessions with so much of it."""
    past = tuple(measured(share * WARM, 10 + k) for k, share in enumerate(history))
    state = start(("warm-up",), WARM, past)
    return replace(state, detections=(candidate(state, "warm-up"),))


@pytest.mark.parametrize("history", [(), (1.0, 1.0), (0.0, 0.0)], ids=["alone", "lasting", "new"])
def test_the_time_constant_is_found_between_the_points_of_the_grid(history: tuple[float, ...]) -> None:
    before = grown(history)
    (found,) = with_refined_shapes(before).detections
    assert found.best.shape.nonlinear[0] == pytest.approx(TAU, rel=0.03)
    assert before.detections[0].best.shape.nonlinear[0] != pytest.approx(TAU, rel=0.1)


def test_a_refined_shape_explains_more() -> None:
    before = grown()
    (found,) = with_refined_shapes(before).detections
    assert found.best.statistic > before.detections[0].best.statistic + 10


def test_a_refined_shape_carries_its_derivative_as_a_column_of_its_own() -> None:
    state = with_refined_shapes(grown())
    (found,) = state.detections
    assert found.best.trace.shape[1] == found.best.shape.columns.shape[-1] == 2
    t = np.exp(-TIME / found.best.shape.nonlinear[0]) * TIME / found.best.shape.nonlinear[0]
    assert np.allclose(found.best.shape.columns[:, SENSOR, 1], t)


def test_an_unknown_time_constant_costs_amplitude_precision() -> None:
    before = grown()
    sigmas = [np.sqrt(amplitudes(s).covariance[0, 0]) for s in (before, with_refined_shapes(before))]
    assert sigmas[1] > 1.05 * sigmas[0]


def test_a_change_left_open_stays_open() -> None:
    state = grown((1.0, 0.0))
    state = replace(state, detections=(candidate(state, "warm-up", open_change=True),))
    (found,) = with_refined_shapes(state).detections
    assert found.best.trace.shape[1] == found.best.shape.columns.shape[-1] == 1 + 5 + 1
    assert np.array_equal(found.best.trace[:, 1:6], state.detections[0].best.trace[:, 1:6])


def test_what_has_no_continuous_parameter_stays_as_it_is() -> None:
    state = start(("bias-jump",), effect("bias-jump"))
    state = replace(state, detections=(candidate(state, "bias-jump"),))
    assert with_refined_shapes(state) is state


def test_where_the_session_does_not_tell_the_shape_the_simple_cause_leads() -> None:
    """A ramp taken for a warm-up of endless time constant: amplitude and time constant would both mean nothing."""
    state = start(("warm-up", "bias-ramp"), 0.15 * effect("bias-ramp"))
    warm, ramp = candidate(state, "warm-up"), candidate(state, "bias-ramp")
    ranking = tuple((f.best, f.best.log_evidence) for f in (warm, ramp))
    (found,) = with_refined_shapes(replace(state, detections=(replace(warm, ranking=ranking),))).detections
    assert found.best.cause.identifier == "bias-ramp"
    assert found.ranking == ranking
