"""Alternatives of a name."""

from dataclasses import replace

import numpy as np
import pytest

from estimator.diagnosis.explanation.extended_model import amplitudes
from estimator.diagnosis.explanation.findings import UNEXPLAINED, excess_finding, findings, noise_cause
from estimator.diagnosis.explanation.rivals import DISTINGUISHED, alternatives, separations
from estimator.diagnosis.selection.ranking import strongest
from estimator.diagnosis.selection.search_state import SearchState
from estimator.diagnosis.signatures.noise import ExcessVariance
from tests.estimator.diagnosis.selection.small import SENSOR, effect, start


def named(identifiers: tuple[str, ...], hidden: str, size: float) -> SearchState:
    """The leading cause selected, the rest its rivals."""
    begun = start(identifiers, size * effect(hidden))
    best = strongest(begun, begun.traces)
    assert best is not None
    return replace(begun, detections=(best,))


@pytest.mark.parametrize("size", [0.15, 0.3, 1.0])
def test_what_lies_five_standard_errors_away_is_no_alternative(size: float) -> None:
    state = named(("cubic-nonlinearity", "odd-quadratic", "bias-jump", "bias-ramp"), "cubic-nonlinearity", size)
    (found,) = state.detections
    others = alternatives(state, found)
    assert all(s.now < DISTINGUISHED for s in separations(state, found, others))


@pytest.mark.parametrize(("unnamed", "listed"), [(0.004, False), (0.02, True), (0.6, True)])
def test_a_course_of_no_name_is_an_alternative_while_it_is_likely(unnamed: float, listed: bool) -> None:
    state = named(("bias-ramp",), "bias-ramp", 1.0)
    state = replace(state, detections=(replace(state.detections[0], unnamed=unnamed),))
    (finding,) = findings(state, amplitudes(state), [None])
    assert (UNEXPLAINED in finding.alternatives) == listed


@pytest.mark.parametrize("doubtful", [False, True])
def test_scatter_in_excess_may_be_something_else(doubtful: bool) -> None:
    state = start(("excess-noise",), np.zeros(1))
    cause = noise_cause(state)
    assert cause is not None
    finding = excess_finding(state, cause, ExcessVariance(SENSOR, 9.0, 19.0, 50.0, 1e-20, doubtful=doubtful))
    assert (UNEXPLAINED in finding.alternatives) == doubtful


def test_no_measurement_is_proposed_where_the_rival_absorbs_everything() -> None:
    state = named(("cubic-nonlinearity",), "cubic-nonlinearity", 1.0)
    (found,) = state.detections
    (same,) = separations(state, found, [found.best])
    assert (same.measurement, same.then) == ("", None)
