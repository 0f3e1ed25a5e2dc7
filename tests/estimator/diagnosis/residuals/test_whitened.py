"""Whitened residuals against the full covariance of all readings, written out densely."""

from dataclasses import replace

import numpy as np
import pytest

from estimator.applied_vector import stand_geometry
from estimator.diagnosis.residuals.baseline import Baseline, block_columns
from estimator.diagnosis.residuals.fitted import baseline_of, stand_baseline
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.session import GYROSCOPE, Array
from estimator.simulate import orientation_schedule
from tests.estimator.calibration.bound import covariance
from tests.estimator.calibration.cases import CASES, SITE, Case, gyros, sphere
from tests.estimator.causes.hiding import scene

STAND = [c for c in CASES if c.name in ("stand", "three-sensors", "gyro-rates", "unequal-steps")]
every_stand = pytest.mark.parametrize("case", STAND, ids=lambda c: c.name)


def at_truth(case: Case) -> Baseline:
    """The baseline of a schedule at the true parameters."""
    session = case.schedule
    repeatability = np.array([s.bias_repeatability for s in session.sensors])
    variance = np.broadcast_to((case.noise / case.truth.scale) ** 2 + repeatability**2, session.readings.shape)
    return stand_baseline(session, case.truth, stand_geometry(session), np.zeros(variance.shape), variance)


def dense(case: Case) -> Array:
    """(R m, R m) covariance of all readings at the input."""
    scale = np.tile(case.truth.scale, len(case.schedule.readings))
    return covariance(case) / np.outer(scale, scale)


@every_stand
def test_whitening_leaves_unit_covariance(case: Case) -> None:
    baseline = at_truth(case)
    R, m = baseline.residual.shape
    whiten = baseline.whiten
    W = whiten(np.eye(R * m).reshape(R, m, R * m))
    common = W @ baseline.constant.reshape(R * m, -1) * baseline.constant_sigma
    assert np.allclose(W @ dense(case) @ W.T - common @ common.T, np.eye(R * m), atol=1e-5)


@every_stand
def test_strength_is_what_the_best_fit_of_the_baseline_leaves(case: Case) -> None:
    baseline = at_truth(case)
    signature = np.random.default_rng(1).normal(size=baseline.residual.shape) * 1e-5 * case.norm
    root = np.linalg.cholesky(np.linalg.inv(dense(case))).T
    J = root @ block_columns(baseline.design).reshape(signature.size, -1)
    left = root @ signature.ravel()
    value = np.linalg.lstsq(J / np.linalg.norm(J, axis=0), left, rcond=1e-12)[0]
    left = left - J / np.linalg.norm(J, axis=0) @ value
    found = np.linalg.norm(WhitenedResiduals.of(baseline).trace(signature[..., None]))
    assert np.isclose(found, np.linalg.norm(left), rtol=1e-4)


@every_stand
def test_the_baseline_itself_leaves_nothing(case: Case) -> None:
    residuals = WhitenedResiduals.of(at_truth(case))
    columns = block_columns(residuals.baseline.design)
    assert np.all(
        np.linalg.norm(residuals.trace(columns), axis=0) < 1e-8 * np.linalg.norm(residuals.whitened(columns), axis=0)
    )


def test_residuals_of_sound_sessions_have_as_much_energy_as_degrees_of_freedom() -> None:
    case = STAND[0]
    energy = [float(e.z @ e.z) / e.freedom for e in (WhitenedResiduals.of(baseline_of(s)) for s in case.simulated(60))]
    freedom = WhitenedResiduals.of(at_truth(case)).freedom
    assert abs(np.mean(energy) - 1) < 4 * np.sqrt(2 / freedom / 60)


def test_unknown_directions_take_two_readings_a_row() -> None:
    baseline = baseline_of(scene("orientations", 0).measured(1))
    R, m = baseline.residual.shape
    residuals = WhitenedResiduals.of(baseline)
    assert residuals.freedom == R * m - 2 * R - (3 * 5 - 3) - 3


def test_a_direction_that_the_sensors_feel_alike_takes_one_reading_a_row() -> None:
    """Two parallel sensors see one of the two turns of an unknown direction: rounding makes no second one."""
    baseline = baseline_of(scene("orientations", 0).measured(1))
    row = np.zeros_like(baseline.row)
    row[:, 0], row[:, 1] = baseline.row[:, 0], 0.3 * baseline.row[:, 0]
    assert np.all(replace(baseline, row=row).whiten.projected_out.sum(axis=1) == 1)


def test_what_the_session_does_not_observe_takes_no_degree_of_freedom() -> None:
    """Scale and bias of a sensor along the axis of rotation are one at a single elevation: rounding makes no second
    one.
    """
    baseline = at_truth(STAND[0])
    n = np.broadcast_to(baseline.setting.n[:1], baseline.setting.n.shape)
    still = replace(baseline, setting=replace(baseline.setting, n=n))
    m = len(still.unstated)
    assert WhitenedResiduals.of(still).freedom == still.residual.size - m


def test_gyros_alone_keep_their_readings_when_nothing_is_known_of_directions() -> None:
    sensors = gyros(3, scale=1.0, unit="rad/s")
    session = replace(orientation_schedule(sensors, SITE, sphere(12)), directions=None)
    rng = np.random.default_rng(1)
    session = replace(session, readings=rng.normal(0, 1e-4, (12, 3)), standard_errors=np.full((12, 3), 1e-4))
    residuals = WhitenedResiduals.of(baseline_of(session))
    assert {s.kind for s in session.sensors} == {GYROSCOPE}
    assert residuals.freedom == 12 * 3 - 3
    assert np.all(residuals.z.reshape(12, 3).std(axis=0) > 0.3)
