"""The gain is measured on positions that took no part, and rewards the true cause only."""

import numpy as np
import pytest

from estimator import diagnose
from estimator.diagnosis.explanation.gain import score
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.residuals.prediction import FOLDS, predicted, predicted_without_effects
from estimator.session import ACCELEROMETER
from tests.estimator.causes.hiding import change, found, scene, with_readings
from tests.estimator.causes.physics import SENSOR


@pytest.mark.parametrize("cause", ["cubic-nonlinearity", "hysteresis", "beta-eccentricity", "stand-drift"])
def test_the_true_cause_predicts_unseen_positions_better(cause: str) -> None:
    gain = found(cause).gain
    assert gain.before.chi2_per_dof > 1.3 > gain.after.chi2_per_dof
    assert gain.after.log_score > gain.before.log_score
    assert gain.after.rms < gain.before.rms


def test_a_wrong_cause_gains_nothing() -> None:
    where = scene(ACCELEROMETER, 0)
    baseline = baseline_of(where.measured(1))
    wrong = change("stand-drift", where)[..., None]
    with_wrong = predicted(baseline, [[wrong]] * FOLDS)
    assert score(baseline, with_wrong).log_score < score(baseline, predicted_without_effects(baseline)).log_score


def test_without_a_finding_before_is_after() -> None:
    gain = diagnose(scene(ACCELEROMETER, 0).measured(1)).gain
    assert gain.before == gain.after
    assert abs(gain.before.chi2_per_dof - 1) < 0.3


def test_excess_noise_costs_its_width_and_pays_by_its_honesty() -> None:
    gain = found("excess-noise").gain
    assert gain.before.chi2_per_dof > 1.3
    assert abs(gain.after.chi2_per_dof - 1) < 0.4
    assert gain.after.log_score > gain.before.log_score


def test_unknown_directions_do_not_count_as_readings() -> None:
    where = scene("orientations", 0)
    baselines = [baseline_of(where.measured(seed)) for seed in range(8)]
    scores = [score(one, predicted_without_effects(one)).chi2_per_dof for one in baselines]
    assert abs(np.mean(scores) - 1) < 0.15


def test_an_effect_of_one_position_does_not_predict_the_others() -> None:
    where = scene(ACCELEROMETER, 0)
    spoilt = with_readings(where.measured(1), change("reading-outlier", where) * where.world.truth.scale)
    gain = diagnose(spoilt).gain
    assert gain.after.log_score > gain.before.log_score


def test_the_error_of_each_sensor_is_that_of_its_held_out_readings() -> None:
    where = scene(ACCELEROMETER, 0)
    baseline = baseline_of(where.measured(1))
    rows = predicted_without_effects(baseline)
    each = score(baseline, rows).rms_by_sensor
    assert each is not None
    names = [sensor.name for sensor in baseline.session.sensors]
    assert list(each[ACCELEROMETER]) == names
    assert np.allclose(list(each[ACCELEROMETER].values()), np.sqrt((rows.error**2).mean(axis=0)))
    gain = found("cubic-nonlinearity").gain
    fall = {
        name: gain.before.rms_by_sensor[ACCELEROMETER][name] / error
        for name, error in gain.after.rms_by_sensor[ACCELEROMETER].items()
    }
    assert max(fall, key=fall.__getitem__) == names[SENSOR]
