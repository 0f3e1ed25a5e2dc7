"""A set of names, or one unknown course of the applied vector?"""

from dataclasses import replace

import numpy as np
import pytest

from estimator.causes import cause
from estimator.causes.contract import Setting
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.selection.acceptance import fitting_causes
from estimator.diagnosis.selection.backward import penalised_log_evidence
from estimator.diagnosis.selection.common_or_own import (
    in_parity_space,
    with_likelier_vector_course,
    with_residual_noise,
)
from estimator.diagnosis.selection.ranking import joint_log_evidence
from estimator.diagnosis.selection.start import begin
from estimator.session import Array
from tests.estimator.diagnosis.selection.small import ROWS, SENSOR, candidate, effect, measured, names, start

OWN = ("cubic-nonlinearity", "scale-asymmetry", "cross-coupling", "bias-per-position", "bias-ramp", "axis-creep")


def turned(setting: Setting, course: Array) -> Array:
    """(R, m) V, what a course (R,) of δα, rad, adds to the readings."""
    assert setting.d_alpha is not None
    return (setting.through(setting.d_alpha[..., None])[..., 0] * course[:, None]) * setting.parameters.scale


def swaying(size: float) -> Array:
    """(R, m) V, what a stand does whose head nods twice a turn, more in the second run."""
    setting = start(()).baseline.setting
    assert setting.beta is not None
    assert setting.flipped is not None
    return turned(setting, size * np.cos(2 * setting.beta + 0.3) * (1 + setting.flipped))


@pytest.mark.slow
def test_an_error_of_the_stand_that_no_cause_describes_gets_no_name() -> None:
    begun = start(OWN, swaying(2e-4))
    left = with_likelier_vector_course(begun, fitting_causes(begun), fitting_causes)
    assert not left.detections
    assert [course.components for course in left.courses] == [("α",)]


def test_the_course_is_the_one_that_was_there() -> None:
    begun = start(OWN, swaying(2e-4))
    (course,) = with_likelier_vector_course(begun, fitting_causes(begun), fitting_causes).courses
    beta, flipped = begun.baseline.setting.beta, begun.baseline.setting.flipped
    true = 2e-4 * np.cos(2 * beta + 0.3) * (1 + flipped)
    assert np.corrcoef(course.value[:, 0], true)[0, 1] > 0.9


def test_a_cause_of_one_sensor_beside_it_is_still_named() -> None:
    begun = start(OWN, swaying(2e-4) + effect("cubic-nonlinearity"))
    left = with_likelier_vector_course(begun, fitting_causes(begun), fitting_causes)
    assert names(left) == [("cubic-nonlinearity", (SENSOR,))]
    assert left.courses


@pytest.mark.parametrize("known", ["beta-second-harmonic", "stand-drift", "axis-wobble", "alpha-shift"])
def test_an_error_of_the_stand_that_a_cause_describes_keeps_its_name(known: str) -> None:
    begun = start((*OWN, known), effect(known))
    left = with_likelier_vector_course(begun, fitting_causes(begun), fitting_causes)
    assert names(left) == [(known, ())]
    assert not left.courses


def test_two_true_causes_of_two_sensors_keep_their_names() -> None:
    begun = start(OWN, effect("cubic-nonlinearity") + effect("bias-ramp", 3))
    left = with_likelier_vector_course(begun, fitting_causes(begun), fitting_causes)
    assert names(left) == [("bias-ramp", (3,)), ("cubic-nonlinearity", (SENSOR,))]


def test_nothing_of_a_course_shows_in_parity_space() -> None:
    """Noise alone is left there: χ² within four of its standard deviations of its degrees of freedom."""
    begun = in_parity_space(start(OWN, swaying(2e-4)), size=False)
    z, freedom = begun.residuals.z, begun.residuals.freedom
    assert abs(z @ z - freedom) < 4 * np.sqrt(2 * freedom)


def test_a_further_name_is_paid_for() -> None:
    state = start(OWN, effect("cubic-nonlinearity") + effect("bias-ramp", 3))
    first = candidate(state, "cubic-nonlinearity")
    one = replace(state, detections=(first,))
    both = replace(one, detections=(first, candidate(one, "bias-ramp", (3,))))
    assert penalised_log_evidence(both) == pytest.approx(joint_log_evidence(both) - np.log(100))
    assert penalised_log_evidence(one) == pytest.approx(joint_log_evidence(one))


def test_noise_that_no_file_states_is_what_the_names_leave() -> None:
    added = effect("beta-second-harmonic")
    unstated = replace(measured(added), standard_errors=np.full((ROWS, 4), np.nan))
    begun = begin(baseline_of(unstated), (), [cause("beta-second-harmonic")])
    named = replace(begun, detections=(candidate(begun, "beta-second-harmonic", ()),))
    known, seen = with_residual_noise(begun, named, begun.baseline.unstated)
    true = baseline_of(measured(0.0)).variance
    assert np.median(begun.baseline.variance / true) > 1.5
    assert np.median(known.baseline.variance / true) == pytest.approx(1, abs=0.3)
    assert names(seen) == names(named)


def test_a_turn_of_the_block_since_the_history_is_common() -> None:
    setting = start(()).baseline.setting
    turn = np.cross(np.array([2e-4, -1e-4, 1e-4]), setting.n)
    added = setting.through(turn[..., None])[..., 0] * setting.parameters.scale
    begun = start(("sensor-drift", *OWN), added, (measured(0.0, 11), measured(0.0, 12)))
    left = with_likelier_vector_course(begun, fitting_causes(begun), fitting_causes)
    assert not left.detections
    assert left.courses
