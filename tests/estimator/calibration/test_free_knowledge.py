"""Arbitrary orientations: what a set tells, what it cannot, and honest uncertainty."""

import json
from dataclasses import replace

import numpy as np
import pytest

from estimator.calibration.free import calibrate_free
from estimator.calibration.free.information import information
from estimator.calibration.free.model import ModelRows, Unknowns
from estimator.errors import ScheduleError
from tests.estimator.calibration.free_sessions import errors, session, sphere, truth


def known(m, directions, quadratic=False):
    """Information of a set of orientations before it is flown."""
    axes, R = truth(m).axes, len(directions)
    unknowns = Unknowns(np.zeros(m), np.zeros(m), np.zeros(m), axes, directions)
    empty = np.zeros((R, 3))
    return information(
        ModelRows(np.zeros((R, m)), np.full((R, m), 1e-6), empty, np.zeros(R), axes), unknowns, quadratic
    )


def two_planes(count):
    """Turns that stay in the XZ and YZ planes."""
    d = sphere(count, np.random.default_rng(8))
    d[::2, 1] = 0
    d[1::2, 0] = 0
    return d / np.linalg.norm(d, axis=1, keepdims=True)


@pytest.mark.parametrize(("count", "rank"), [(8, 12), (9, 13), (40, 13)])
def test_nine_generic_orientations_determine_thirteen_parameters_of_four_sensors(count, rank):
    found = known(4, sphere(count, np.random.default_rng(3)))
    assert (found.rank, found.parameters) == (rank, 13)


@pytest.mark.parametrize("count", [12, 40, 200])
def test_turns_in_two_planes_never_determine_the_thirteenth(count):
    assert known(4, two_planes(count)).rank == 12


def test_what_two_planes_leave_open_is_a_result():
    result = calibrate_free(session(truth(4), two_planes(30)), quadratic=False)
    assert (result.fit.rank, result.fit.parameters) == (12, 13)
    assert not result.sensors[0].observable["scale"]
    assert result.sensors[0].scale.value is None
    assert result.fit.weakest[1] > 0.1
    assert result.fit.converged
    json.dumps(result.to_dict(), allow_nan=False)


def test_the_reading_at_zero_input_is_known_though_scale_and_bias_are_not():
    true = truth(4)
    sensor = calibrate_free(session(true, two_planes(30)), quadratic=False).sensors[0]
    (together,) = sensor.known
    scale, bias = together.coefficients["scale"], together.coefficients["bias"]
    assert scale / bias == pytest.approx(true.bias[0] / true.scale[0], rel=0.1)
    assert together.sigma < 1e-5


def test_too_few_rows_say_how_many_to_add():
    with pytest.raises(ScheduleError, match=r"3 orientations are too few.*add at least 6.*9 or more"):
        calibrate_free(session(truth(4), sphere(3, np.random.default_rng(0))))


def test_a_block_that_was_never_turned_is_refused():
    with pytest.raises(ScheduleError, match="all 12 rows have the same orientation"):
        calibrate_free(session(truth(4), np.tile([0.0, 0.0, 1.0], (12, 1))))


def test_axes_in_one_plane_are_refused():
    true = replace(truth(3), nominal=np.array([[1.0, 0, 0], [0, 1, 0], [0.6, 0.8, 0]]))
    with pytest.raises(ScheduleError, match="do not span space"):
        calibrate_free(session(true, sphere(12, np.random.default_rng(0))))


def test_a_dead_sensor_is_left_out_and_said_to_be_unknown():
    measured = session(truth(6), sphere(24, np.random.default_rng(1)))
    stuck = measured.readings.copy()
    stuck[:, 3] = 0.4
    result = calibrate_free(replace(measured, readings=stuck))
    assert set(result.sensor("A4").observable.values()) == {False}
    assert all(s.observable["scale"] for s in result.sensors if s.name != "A4")
    assert result.fit.p_value > 1e-3
    json.dumps(result.to_dict(), allow_nan=False)


def test_too_few_live_sensors_are_named():
    measured = session(truth(3), sphere(24, np.random.default_rng(1)))
    stuck = measured.readings.copy()
    stuck[:, 1] = 0.4
    with pytest.raises(ScheduleError, match="A2 did not respond"):
        calibrate_free(replace(measured, readings=stuck))


FACES = np.vstack([np.eye(3), -np.eye(3)])


def labelled(true, directions, sigma, seed=0):
    """A session whose true directions differ from the stated ones by ``sigma``."""
    rng = np.random.default_rng(seed)
    really = directions + sigma * rng.standard_normal(directions.shape)
    really /= np.linalg.norm(really, axis=1, keepdims=True)
    return replace(session(true, really), directions=directions, direction_sigma=sigma)


def test_six_labelled_positions_are_enough():
    true = truth(3, turn=False)
    result = calibrate_free(labelled(true, FACES, np.radians(1)), quadratic=False)
    d, sigma = errors(result, true), np.sqrt(np.diagonal(result.covariance))
    free = np.isfinite(sigma)
    assert free.sum() == 12
    assert np.all(np.abs(d[free]) < 3.5 * sigma[free])
    assert result.gauge == "directions"
    assert np.degrees(result.sensors[0].axis_sigma) == pytest.approx(np.sqrt(2 / 2), rel=0.3)


def test_labels_of_some_rows_help_the_others():
    true = truth(4, turn=False)
    directions = np.vstack([FACES, sphere(14, np.random.default_rng(1))])
    measured = labelled(true, directions, np.radians(0.2))
    stated = np.where(np.arange(20)[:, None] < 6, directions, np.nan)
    result = calibrate_free(replace(measured, directions=stated), quadratic=False)
    d, sigma = errors(result, true), np.sqrt(np.diagonal(result.covariance))
    assert np.all(np.abs(d) <= 4 * np.nan_to_num(sigma, nan=np.inf))
    assert result.fit.dof == 20 * 4 + 12 - 40 - 16


def test_noise_is_estimated_where_none_is_stated():
    result = calibrate_free(
        session(truth(6), sphere(60, np.random.default_rng(1)), noise=2e-3, stated=False), quadratic=False
    )
    assert result.fit.noise == "estimated"
    assert result.fit.p_value is None
    np.testing.assert_allclose(result.residuals.sigma.mean(axis=0), 2e-3, rtol=0.35)


def test_each_sensor_has_its_own_noise_when_there_is_enough_redundancy():
    true, rng = truth(6), np.random.default_rng(4)
    measured = session(true, sphere(80, rng), noise=1e-4, stated=False)
    noisy = measured.readings.copy()
    noisy[:, 2] += 0.12 * 5e-3 * rng.standard_normal(80)
    found = calibrate_free(replace(measured, readings=noisy), quadratic=False).residuals.sigma[0]
    assert found[2] == pytest.approx(5e-3, rel=0.35)
    assert np.all(np.delete(found, 2) < 5e-4)


def test_noise_that_cannot_explain_the_residuals_enlarges_the_uncertainty():
    measured = session(truth(6), sphere(40, np.random.default_rng(1)), noise=1e-3)
    honest = calibrate_free(measured, quadratic=False)
    boast = calibrate_free(replace(measured, standard_errors=measured.standard_errors / 10), quadratic=False)
    assert honest.fit.covariance_factor == 1.0
    assert boast.fit.p_value < 1e-3
    assert boast.sensors[0].scale.sigma == pytest.approx(honest.sensors[0].scale.sigma, rel=0.2)


def test_bias_repeatability_adds_to_the_noise():
    measured = session(truth(6), sphere(40, np.random.default_rng(1)), noise=1e-4)
    wandering = replace(measured, sensors=tuple(replace(s, bias_repeatability=1e-3) for s in measured.sensors))
    np.testing.assert_allclose(calibrate_free(wandering).residuals.sigma, np.hypot(1e-4, 1e-3), rtol=0.01)


def test_positions_that_do_not_repeat_are_given_the_uncertainty_that_they_have():
    true, d = truth(4), sphere(24, np.random.default_rng(5))
    stated, rng, total = np.full((24, 4), 0.12e-5), np.random.default_rng(6), 0.0
    stated[0] = 0.12e-7
    for _ in range(60):
        measured = replace(session(true, d, noise=1e-3, rng=rng), standard_errors=stated)
        result = calibrate_free(measured, quadratic=False)
        error, sigma = errors(result, true), np.sqrt(np.diagonal(result.covariance))
        seen = np.isfinite(sigma)
        total += np.mean((error[seen] / sigma[seen]) ** 2) / 60
    assert total == pytest.approx(1.0, abs=0.3)


def test_a_plain_quadratic_term_is_estimated_although_noise_is_large():
    true = truth(6, quadratic=2e-2)
    result = calibrate_free(session(true, sphere(40, np.random.default_rng(2)), noise=1e-2))
    assert result.sensors[0].quadratic.value == pytest.approx(
        true.quadratic[0], abs=4 * result.sensors[0].quadratic.sigma
    )
    assert result.sensors[0].quadratic.sigma * 9.81 > 1e-4


@pytest.mark.parametrize("size", [1.0, 1e3, 1e9])
@pytest.mark.parametrize("count", [4, 8, 30])
def test_readings_without_sense_give_a_result_that_json_can_hold(size, count):
    measured = session(truth(4), sphere(count, np.random.default_rng(0)))
    nonsense = 0.12 * 9.81 * (1 + size * np.random.default_rng(1).standard_normal((count, 4)))
    result = calibrate_free(replace(measured, readings=nonsense))
    assert json.loads(json.dumps(result.to_dict(), allow_nan=False))["fit"]["dof"] == result.fit.dof


def test_axes_that_share_planes_leave_no_hole():
    true = replace(truth(4), nominal=np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 1]]))
    faces = session(replace(true, axes=true.nominal), np.vstack([FACES, FACES]))
    result = calibrate_free(faces)
    assert result.fit.rank < result.fit.parameters
    json.dumps(result.to_dict(), allow_nan=False)
