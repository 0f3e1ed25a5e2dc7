"""Arbitrary orientations: what every calibrator must do, on sets that determine everything."""

from dataclasses import replace

import numpy as np
import pytest

from estimator import read_session
from estimator.calibration.free import accelerometer_rows, calibrate_free
from estimator.calibration.free.model import ModelRows, Unknowns, jacobian, linearise, predicted
from estimator.calibration.free.optional import starts_around
from estimator.calibration.free.schedule import classified
from estimator.calibration.free.solve import search
from estimator.calibration.free.start import starts
from tests.builders import arbitrary_orientations
from tests.estimator.calibration.free_sessions import errors, session, sphere, truth


@pytest.mark.parametrize("m", [3, 4, 6, 24])
def test_truth_lies_within_the_stated_uncertainty(m):
    true = truth(m, seed=m)
    result = calibrate_free(session(true, sphere(30, np.random.default_rng(m))), quadratic=False)
    free = np.isfinite(np.diagonal(result.covariance))
    covariance = result.covariance[np.ix_(free, free)]
    d = errors(result, true)[free]
    normalised = d @ np.linalg.pinv(covariance, rcond=1e-12, hermitian=True) @ d
    assert normalised < result.fit.rank + 4 * np.sqrt(2 * result.fit.rank)
    assert np.all(np.abs(d) < 4.5 * np.sqrt(np.diagonal(covariance)))
    assert result.fit.rank == result.fit.parameters == 4 * m - 3
    assert result.fit.p_value > 1e-3


@pytest.fixture(scope="module")
def trials():
    """Errors (n, P) and covariances (n, P, P) of repeated sessions; four sensors, twelve orientations."""
    rng, true = np.random.default_rng(11), truth(4, seed=3)
    directions = sphere(14, np.random.default_rng(5))
    results = [calibrate_free(session(true, directions, noise=1e-3, rng=rng), quadratic=False) for _ in range(700)]
    free = np.isfinite(np.diagonal(results[0].covariance))
    return np.array([errors(r, true)[free] for r in results]), np.array(
        [r.covariance[np.ix_(free, free)] for r in results]
    )


def test_variance_reaches_the_cramer_rao_bound(trials):
    found, covariances = trials
    bound = covariances.mean(axis=0)
    values, vectors = np.linalg.eigh(bound / np.sqrt(np.outer(np.diag(bound), np.diag(bound))))
    kept = values > 1e-9
    whitened = (found / np.sqrt(np.diag(bound))) @ vectors[:, kept] / np.sqrt(values[kept])
    assert kept.sum() == 13
    assert np.mean(whitened**2) == pytest.approx(1.0, abs=0.05)


def test_ninety_five_per_cent_intervals_hold(trials):
    found, covariances = trials
    sigma = np.sqrt(np.diagonal(covariances, axis1=1, axis2=2))
    assert 0.93 < np.mean(np.abs(found) < 1.96 * sigma) < 0.97


def test_jacobian_is_the_numerical_derivative():
    rng = np.random.default_rng(0)
    true = truth(4, quadratic=1e-2)
    at = Unknowns(
        0.1 * rng.standard_normal(4), rng.standard_normal(4), 0.1 * rng.standard_normal(4), true.axes, sphere(5, rng)
    )
    own, shared = jacobian(at)
    for i in range(20):
        step = 1e-6 * np.eye(20)[i]
        slope = predicted(at.stepped(step, np.zeros((5, 2)))) - predicted(at.stepped(-step, np.zeros((5, 2))))
        np.testing.assert_allclose(slope[:, i // 5] / 2e-6, own[:, i // 5, i % 5], atol=1e-8)
    for k in range(2):
        step = np.zeros((5, 2))
        step[:, k] = 1e-6
        slope = predicted(at.stepped(np.zeros(20), step)) - predicted(at.stepped(np.zeros(20), -step))
        np.testing.assert_allclose(slope / 2e-6, shared[..., k], atol=1e-8)


def test_eliminating_the_orientations_equals_inverting_the_whole():
    rng = np.random.default_rng(1)
    true, d = truth(4), sphere(6, rng)
    at = Unknowns(np.zeros(4), np.zeros(4), np.zeros(4), true.axes, d)
    rows = ModelRows(predicted(at), np.full((6, 4), 0.01), d, np.full(6, 1e3), true.nominal)
    own, shared = jacobian(at)
    whole = np.zeros((24, 20 + 12))
    for j in range(6):
        for i in range(4):
            whole[4 * j + i, 5 * i : 5 * i + 5] = own[j, i]
            whole[4 * j + i, 20 + 2 * j : 22 + 2 * j] = shared[j, i]
    normal = whole.T @ whole / 0.01**2 + np.diag(np.r_[np.zeros(20), np.full(12, 1e3)])
    schur = normal[:20, :20] - normal[:20, 20:] @ np.linalg.inv(normal[20:, 20:]) @ normal[20:, :20]
    np.testing.assert_allclose(linearise(rows, at).schur, schur, atol=1e-9 * np.abs(schur).max())


def test_the_order_of_the_rows_does_not_matter():
    measured = session(truth(6), sphere(20, np.random.default_rng(2)))
    order = np.random.default_rng(3).permutation(20)
    shuffled = replace(measured, readings=measured.readings[order], standard_errors=measured.standard_errors[order])
    one, other = calibrate_free(measured), calibrate_free(shuffled)
    for a, b in zip(one.sensors, other.sensors, strict=True):
        np.testing.assert_allclose(a.axis, b.axis, atol=1e-9)
        assert a.scale.value == pytest.approx(b.scale.value, rel=1e-9)
        assert a.bias.sigma == pytest.approx(b.bias.sigma, rel=1e-6)


def test_the_names_of_the_blocks_axes_do_not_matter():
    measured = session(truth(6), sphere(20, np.random.default_rng(2)))
    turn = np.array([[0.0, 0.6, 0.8], [0.0, -0.8, 0.6], [1.0, 0.0, 0.0]])
    renamed = replace(measured, sensors=tuple(replace(s, nominal_axis=turn @ s.nominal_axis) for s in measured.sensors))
    one, other = calibrate_free(measured), calibrate_free(renamed)
    for a, b in zip(one.sensors, other.sensors, strict=True):
        np.testing.assert_allclose(turn @ a.axis, b.axis, atol=1e-9)
        assert a.scale.value == pytest.approx(b.scale.value, rel=1e-9)
        assert a.axis_sigma == pytest.approx(b.axis_sigma, rel=1e-6)


def test_the_frame_shows_no_net_turn_against_the_nominal_axes():
    result = calibrate_free(session(truth(4, turn=False), sphere(20, np.random.default_rng(2))))
    net = np.cross(truth(4).nominal, [s.axis for s in result.sensors]).sum(axis=0)
    np.testing.assert_allclose(net, 0, atol=1e-12)
    assert result.gauge == "nominal-axes"


@pytest.mark.parametrize("stated_offset", [None, 32768.0])
def test_raw_counts_with_half_the_converters_range_as_offset(stated_offset):
    true = truth(3, scale_error=0.15, seed=4)
    counts = replace(true, scale=true.scale * 3400)
    measured = session(counts, sphere(25, np.random.default_rng(2)))
    measured = replace(
        measured,
        readings=measured.readings + 32768.0,
        sensors=tuple(replace(s, nominal_scale=408.0, nominal_offset=stated_offset) for s in measured.sensors),
    )
    result = calibrate_free(measured, quadratic=False)
    for i, sensor in enumerate(result.sensors):
        assert sensor.scale.value == pytest.approx(counts.scale[i], abs=5 * sensor.scale.sigma)
        offset = counts.bias[i] + (0 if stated_offset else 32768.0 / counts.scale[i])
        assert sensor.bias.value == pytest.approx(offset, abs=5 * sensor.bias.sigma)


def test_the_quadratic_term_is_estimated_when_the_set_shows_it():
    true = truth(6, quadratic=1e-4)
    result = calibrate_free(session(true, sphere(40, np.random.default_rng(2))))
    for i, sensor in enumerate(result.sensors):
        assert sensor.observable["quadratic"]
        assert sensor.quadratic.value == pytest.approx(true.quadratic[i], abs=4.5 * sensor.quadratic.sigma)


def test_the_quadratic_term_is_left_out_when_noise_hides_it():
    result = calibrate_free(session(truth(3), sphere(14, np.random.default_rng(2)), noise=0.05))
    assert [s.quadratic.value for s in result.sensors] == [None, None, None]
    assert not result.sensors[0].observable["quadratic"]


def test_gyros_at_rest_give_their_bias_and_nothing_else():
    result = calibrate_free(session(truth(3), sphere(24, np.random.default_rng(2)), gyros=3))
    gyro = result.sensor("G2")
    assert gyro.observable == {"scale": False, "bias": True, "quadratic": False, "axis": False}
    assert gyro.bias.value == pytest.approx(1e-3, abs=3 * gyro.bias.sigma)
    assert gyro.bias.sigma == pytest.approx(7.292115e-5 / np.sqrt(3 * 24), rel=0.01)
    assert gyro.scale.value is None
    assert result.sensor("A1").observable["scale"]


def test_a_gyro_that_wanders_has_the_uncertainty_of_its_scatter():
    measured = session(truth(3), sphere(24, np.random.default_rng(2)), gyros=3)
    wandering = measured.readings.copy()
    wandering[:, 4] += 1e-2 * np.random.default_rng(3).standard_normal(24)
    result = calibrate_free(replace(measured, readings=wandering))
    assert result.sensor("G2").bias.sigma == pytest.approx(1e-2 / np.sqrt(24), rel=0.4)
    assert result.sensor("G1").bias.sigma < 1e-4


def test_a_sensor_between_gyros_keeps_its_place():
    measured = session(truth(3), sphere(24, np.random.default_rng(2)), gyros=3)
    order = [3, 0, 4, 1, 5, 2]
    mixed = replace(
        measured,
        sensors=tuple(measured.sensors[k] for k in order),
        readings=measured.readings[:, order],
        standard_errors=measured.standard_errors[:, order],
    )
    one, other = calibrate_free(measured), calibrate_free(mixed)
    for name in ("A1", "A2", "A3", "G1", "G3"):
        assert one.sensor(name).bias.value == pytest.approx(other.sensor(name).bias.value, rel=1e-6)
    index = {n: k for k, n in enumerate(other.names)}
    assert other.covariance[index["A2.scale"], index["A2.scale"]] == pytest.approx(other.sensor("A2").scale.sigma ** 2)


def test_nothing_is_looked_for_around_a_search_that_has_not_ended():
    """Rows of which one is absurd: standard errors mean nothing where χ² still falls, and each search takes long."""
    document = arbitrary_orientations(3, orientations=12, direction_sigma_deg=1.0)
    document["table"]["A1"][1] = 0.0
    absurd = read_session(document)
    rows, _ = accelerometer_rows(absurd, classified(absurd)[0], 9.81)
    found = search(rows, starts(rows)[0], False)
    assert not found.converged
    assert starts_around(found) == []
