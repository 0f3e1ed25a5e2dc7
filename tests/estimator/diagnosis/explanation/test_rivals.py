"""Alternatives of a name."""

from dataclasses import replace

import pytest

from estimator.causes import CATALOGUE, cause
from estimator.causes.catalogue import UNEXPLAINED
from estimator.diagnosis.diagnose import initial_state
from estimator.diagnosis.explanation.extended_model import amplitudes
from estimator.diagnosis.explanation.findings import excess_finding, findings, noise_cause
from estimator.diagnosis.explanation.rivals import DISTINGUISHED, alternatives, separations
from estimator.diagnosis.posterior.explained import ExcessVariance, ExplainedSession
from estimator.diagnosis.posterior.write import posterior
from estimator.diagnosis.residuals.fitted import baseline_of
from tests.estimator.diagnosis.small import SENSOR, effect, measured


def named(hidden: str, size: float) -> ExplainedSession:
    """A session with a cause that is found."""
    return posterior(initial_state(baseline_of(measured(size * effect(hidden))), (), CATALOGUE))


@pytest.mark.parametrize("size", [0.3, 1.0])
def test_what_lies_five_standard_errors_away_is_no_alternative(size: float) -> None:
    state = named("cubic-nonlinearity", size)
    (found,) = state.detections
    others = alternatives(state, found)
    assert all(s.now < DISTINGUISHED for s in separations(state, found, others))


@pytest.mark.parametrize(("unnamed", "listed"), [(0.004, False), (0.02, True), (0.6, True)])
def test_a_course_of_no_name_is_an_alternative_while_it_is_likely(unnamed: float, listed: bool) -> None:
    state = named("bias-ramp", 1.0)
    state = replace(state, detections=(replace(state.detections[0], unnamed=unnamed),))
    (finding,) = findings(state, amplitudes(state), [None])
    shares = {rival.cause: rival.probability for rival in finding.ranking}
    assert (UNEXPLAINED in finding.alternatives) == listed
    assert shares.get(UNEXPLAINED) == (unnamed if listed else None)
    assert sum(rival.probability for rival in finding.ranking) == pytest.approx(1.0, abs=1e-2)


@pytest.mark.parametrize("doubtful", [False, True])
def test_scatter_in_excess_may_be_something_else(doubtful: bool) -> None:
    state = initial_state(baseline_of(measured()), (), [cause("excess-noise")])
    known = noise_cause(state)
    assert known is not None
    finding = excess_finding(state, known, ExcessVariance(SENSOR, 9.0, 19.0, 50.0, 1e-20, doubtful=doubtful))
    assert (UNEXPLAINED in finding.alternatives) == doubtful


def test_no_measurement_is_proposed_where_the_rival_absorbs_everything() -> None:
    state = named("cubic-nonlinearity", 1.0)
    (found,) = state.detections
    (same,) = separations(state, found, [found.best])
    assert (same.measurement, same.then) == ("", None)
