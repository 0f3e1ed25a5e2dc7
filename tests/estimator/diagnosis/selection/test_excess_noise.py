"""Scatter beyond the stated noise: noise, a smooth course, or either."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

from estimator.diagnosis.selection.excess_noise import (
    excess_as_course,
    largest_excess,
    noise_or_course,
    overdispersed,
    sensor_scatter,
    with_autocorrelation,
    with_unknown_noise,
)
from estimator.diagnosis.selection.forward import forward_selection
from estimator.diagnosis.selection.search_state import LEVEL
from estimator.diagnosis.signatures.autocorrelation import autocorrelation
from estimator.diagnosis.signatures.noise import PLAIN, Autocorrelation, ExcessVariance
from tests.estimator.diagnosis.selection.small import ROWS, SENSOR, candidate, effect, on_sensor, start

FEW = ("cubic-nonlinearity",)
NOISE = on_sensor(6 * np.random.default_rng(3).standard_normal(ROWS))
EXCESS = ExcessVariance(SENSOR, 9.0, 19.0, 50.0, 1e-20)


def course(log_evidence: float) -> Autocorrelation:
    return Autocorrelation(SENSOR, "the order measured", log_evidence, ratio=9.0, excess_log_evidence=50.0)


def test_a_sound_sensor_exceeds_nothing() -> None:
    assert largest_excess(start(FEW)) is None


def test_the_noisiest_sensor_is_told_with_its_ratio() -> None:
    excess = largest_excess(start(FEW, NOISE + on_sensor(3 * np.random.default_rng(4).standard_normal(ROWS), 3)))
    assert excess is not None
    assert excess.sensor == SENSOR
    assert 4 < excess.ratio < 100


def test_the_excess_is_weighed_as_a_larger_variance_of_unknown_size() -> None:
    state = start(FEW, on_sensor(4 * np.random.default_rng(3).standard_normal(ROWS)))
    energy, freedom = (x[SENSOR] for x in sensor_scatter(state))
    excess = largest_excess(state)
    assert excess is not None
    likelier = -0.5 * freedom * np.log(energy / freedom) - 0.5 * freedom + 0.5 * energy
    assert excess.log_evidence == pytest.approx(likelier - np.log(np.sqrt(freedom / 2)) - np.log(4))
    assert (excess.ratio, excess.freedom) == (energy / freedom, freedom)


def test_the_chance_of_an_excess_counts_every_sensor_and_every_cause() -> None:
    state = start(FEW, on_sensor(4 * np.random.default_rng(3).standard_normal(ROWS)))
    energy, freedom = (x[SENSOR] for x in sensor_scatter(state))
    excess = largest_excess(state)
    assert excess is not None
    assert excess.p_family == pytest.approx(chi2.sf(energy, freedom) * 4 * state.families, rel=1e-6)


@pytest.mark.parametrize("attributed", ["excess", "unstated"])
def test_scatter_is_attributed_once_and_needs_a_stated_noise(attributed: str) -> None:
    state = start(FEW, NOISE)
    known = replace(state, excess=(EXCESS,)) if attributed == "excess" else with_unknown_noise(state, SENSOR)
    assert largest_excess(known) is None


def test_a_finding_takes_its_energy_and_its_degree_of_freedom_out_of_the_scatter() -> None:
    state = start(FEW, effect("cubic-nonlinearity"))
    named = replace(state, detections=(candidate(state, "cubic-nonlinearity"),))
    (before, freedom), (after, less) = sensor_scatter(state), sensor_scatter(named)
    assert before[SENSOR] - after[SENSOR] > 400
    assert freedom.sum() - less.sum() == pytest.approx(1.0, abs=1e-6)


def test_degrees_of_freedom_of_the_sensors_add_up() -> None:
    state = start(FEW)
    _, freedom = sensor_scatter(state)
    assert abs(freedom.sum() - state.residuals.freedom) < 3, "priors of the stand's errors hold the rest"


def test_a_sensor_called_noisy_is_overdispersed() -> None:
    assert overdispersed(forward_selection(start(FEW, NOISE))) == [False, True, False, False]


def test_without_a_stated_noise_a_sensor_noisier_than_the_others_is_overdispersed() -> None:
    state = start(FEW)
    ratios = np.array([1.0, 0.01, 0.0, 1.0])
    baseline = replace(state.baseline, expected_ratio=ratios)
    blind = replace(state, residuals=replace(state.residuals, baseline=baseline))
    assert overdispersed(blind) == [False, True, False, False]


@pytest.mark.parametrize(
    ("log_evidence", "kinds"),
    [(-1.0, [ExcessVariance]), (PLAIN / 2, [ExcessVariance, Autocorrelation]), (2 * PLAIN, [Autocorrelation])],
    ids=["noise", "either", "course"],
)
def test_scatter_is_noise_a_course_or_doubtful(log_evidence: float, kinds: list[type]) -> None:
    assert [type(s) for s in noise_or_course(EXCESS, course(log_evidence))] == kinds


def test_doubtful_scatter_raises_the_variance_once() -> None:
    assert np.prod([s.ratio for s in noise_or_course(EXCESS, course(PLAIN / 2))]) == EXCESS.ratio


def test_a_residual_too_short_to_judge_is_noise() -> None:
    assert noise_or_course(EXCESS, None) == (EXCESS,)


def test_a_course_carries_the_excess_that_led_to_it() -> None:
    state = start(FEW, on_sensor(14 * np.cumsum(np.random.default_rng(0).standard_normal(ROWS))))
    noisy = largest_excess(state)
    assert noisy is not None
    found = excess_as_course(state, noisy)
    assert found is not None
    assert (found.ratio, found.excess_log_evidence) == (noisy.ratio, noisy.log_evidence)


def test_a_residual_of_the_stated_size_that_runs_smoothly_is_told_at_the_end() -> None:
    place = np.linspace(-1, 1, ROWS)
    state = with_autocorrelation(start(FEW, on_sensor(12 * np.abs(place) ** 3)))
    assert [a.sensor for a in state.autocorrelated] == [SENSOR]


def test_white_residuals_are_not_autocorrelated() -> None:
    assert with_autocorrelation(start(FEW)).autocorrelated == ()


@pytest.mark.slow
def test_smoothness_must_be_significant_among_all_sensors() -> None:
    """A course whose chance is below the level for one sensor, and above it for one of four."""
    place = np.linspace(-1, 1, ROWS)
    for size in np.linspace(1, 12, 200):
        state = start(FEW, on_sensor(size * np.abs(place) ** 3))
        found = autocorrelation(state.residuals, state.attributed(), SENSOR, known=True)
        assert found is not None
        if found.p_value < LEVEL:
            break
    assert LEVEL / 4 < found.p_value < LEVEL
    assert with_autocorrelation(state).autocorrelated == ()
