"""A name holds whether or not the stated noise that it rests on is right."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import f

from estimator import CalibrationSession, diagnose
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.selection.acceptance import accepted_against_course, confirmed
from estimator.diagnosis.selection.confirmation import (
    doubtful_claims,
    evidence_of_larger_noise,
    p_value_in_unknown_noise,
)
from estimator.diagnosis.selection.excess_noise import sensor_scatter
from estimator.diagnosis.selection.start import begin, with_residual_scatter
from estimator.simulate import simulate
from tests.estimator.calibration.cases import accelerometers, block
from tests.estimator.causes.worlds import truth_of, wandering
from tests.estimator.diagnosis.selection.small import SENSOR, candidate, effect, measured, names, start
from tests.estimator.diagnosis.selection.test_noise_claim import stated

FEW = wandering(block(accelerometers(4), 8))
NOISE = np.full(4, 3e-6)
SECOND = slice(SENSOR, SENSOR + 1)


def sound(seed: int) -> CalibrationSession:
    """Eight positions in both runs; nothing acts."""
    return simulate(FEW, truth_of(FEW), np.random.default_rng([61, seed]), noise=NOISE)


@pytest.mark.slow
def test_errors_of_one_sensor_three_times_too_small_give_it_no_other_name() -> None:
    """Eleven readings beyond the parameters: too few to say that the noise is wrong, few enough to find a shape in."""
    found = [diagnose(stated(sound(seed), 1 / 3, SECOND)).findings for seed in range(30)]
    assert not any(g.sensors and g.cause != "excess-noise" for one in found for g in one)


def test_of_a_name_on_one_sensor_the_doubtful_tail_is_that_of_f() -> None:
    state = start(("bias-jump",), 0.2 * effect("bias-jump"))
    found = candidate(state, "bias-jump")
    state = replace(state, detections=(found,))
    energy, freedom = (x[SENSOR] for x in sensor_scatter(state))
    expected = f.sf(found.best.statistic / (energy / freedom), 1, freedom) * found.best.places * state.families
    assert p_value_in_unknown_noise(state, found, SENSOR) == pytest.approx(expected, rel=0.02)


def test_a_name_that_stated_noise_alone_bears_is_doubted() -> None:
    session = stated(measured(0.12 * effect("bias-jump")), 0.5, SECOND)
    state = begin(baseline_of(session), (), start(("bias-jump",)).catalogue)
    state = replace(state, detections=(candidate(state, "bias-jump"),))
    assert [claim.sensors for claim in doubtful_claims(state)] == [(SENSOR,)]


def test_a_strong_name_holds_and_the_search_stands_as_it_is() -> None:
    session = stated(measured(effect("bias-jump")), 0.55, SECOND)
    begun = begin(baseline_of(session), (), start(("bias-jump",)).catalogue)
    state = accepted_against_course(begun)
    assert doubtful_claims(state)
    assert confirmed(begun, state) is state
    assert names(state) == [("bias-jump", (SENSOR,))]


def test_noise_that_is_not_stated_is_not_doubted() -> None:
    session = measured()
    errors = np.where(np.arange(4) == SENSOR, np.nan, session.standard_errors)
    _, larger = evidence_of_larger_noise(begin(baseline_of(replace(session, standard_errors=errors)), (), ()))
    assert np.isfinite(larger).tolist() == [i != SENSOR for i in range(4)]


def test_noise_that_hides_behind_the_stand_is_seen_in_the_whole_session() -> None:
    """The stand's β errors are large: a sensor that is believed too much draws them to its own readings."""
    schedule = replace(FEW, stand=replace(FEW.stand, sigma=replace(FEW.stand.sigma, beta=2e-5)))
    own, whole = [], []
    for seed in range(20):
        session = simulate(schedule, truth_of(schedule), np.random.default_rng([63, seed]), noise=NOISE)
        state = begin(baseline_of(stated(session, 1 / 3, SECOND)), (), start(("bias-jump",)).catalogue)
        state = replace(state, detections=(candidate(state, "bias-jump"),))
        energy, freedom = (x[SENSOR] for x in sensor_scatter(state))
        own.append(energy / freedom)
        whole.append(evidence_of_larger_noise(state)[0][SENSOR])
    assert np.median(whole) > 1.5 * np.median(own)


@pytest.mark.slow
@pytest.mark.parametrize("strength", [0.0, 1.0])
def test_a_factor_common_to_sensors_is_found_beside_a_stand_and_a_named_effect(strength: float) -> None:
    """Restricted likelihood: what all share of a row hides part of a noise that is believed too much."""
    added, ratios = strength * effect("bias-jump"), []
    for seed in range(100, 160):
        baseline = baseline_of(stated(measured(added, seed), 1 / 3, slice(0, 2)))
        named = candidate(begin(baseline, (), start(("bias-jump",)).catalogue), "bias-jump") if strength else None
        scaled = with_residual_scatter(baseline, [[0, 1]], None if named is None else named.best.shape.columns)
        ratios.append(np.median(scaled.variance / baseline.variance, axis=0))
    assert np.mean(ratios, axis=0) == pytest.approx([9.0, 9.0, 1.0, 1.0], rel=0.1)
