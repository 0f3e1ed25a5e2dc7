"""Means of rests in which the block tilts: each sensor's own error, and the tilt that all share."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.signal import lfilter

from estimator.arrays import tangents, unit
from estimator.calibration import calibrate
from estimator.calibration.free import calibrate_free, residual_per_freedom, tilt_response
from estimator.errors import FormatError
from estimator.reading import read_session
from estimator.rest_noise import STEADY, Tilting, Waves, rest_noise, weighed
from estimator.rest_tilt import errors_of_means
from estimator.static import average
from estimator.writing import session_document
from tests.builders import accelerometer_block, raw_log
from tests.estimator.test_static import BIAS, NOISE, SCALE, G, raw

POSES, STILL = 20, 400
BLOCKS = 16


def tilted_log(size, seed=0, poses=POSES, directions=None):
    """A triad's raw log with labelled rests that tilt by ``size`` rad, correlated over a second; and its own noise."""
    rng = np.random.default_rng(seed)
    up = unit(rng.standard_normal((poses, 3))) if directions is None else directions
    decay = np.exp(-0.01)
    drawn = rng.standard_normal((poses * (STILL + 500), 2))
    wander = lfilter([np.sqrt(1 - decay**2)], [1, -decay], drawn, axis=0).reshape(poses, -1, 2)[:, 500:]
    force = G * unit(up[:, None] + size * wander @ np.swapaxes(tangents(up), 1, 2))
    own = NOISE * rng.standard_normal(force.shape)
    readings = SCALE * (force + BIAS) + own
    position = np.repeat(np.arange(poses), STILL)
    return (
        raw(readings.reshape(-1, 3), position=position),
        own[:, 20:-20].mean(axis=1),
        size * wander[:, 20:-20].mean(1),
    )


@cache
def averaged_log(size):
    log, own, tilt = tilted_log(size)
    return average(log, residual_per_freedom), average(log, residual_per_freedom, tilt_response), own, tilt


def rms(values):
    return np.sqrt(np.mean(np.square(values)))


def test_a_tilt_is_no_sensor_s_own_error():
    together, apart, own, _ = averaged_log(1e-3)
    assert rms(together.standard_errors) > 3 * rms(own)
    assert rms(apart.standard_errors) == pytest.approx(rms(own), rel=0.3)


def test_the_mean_tilt_of_a_row_is_stated():
    _, apart, _, tilt = averaged_log(1e-3)
    assert rms(apart.tilt_error) == pytest.approx(rms(tilt), rel=0.4)


def test_a_block_that_does_not_tilt_keeps_its_errors():
    together, apart, *_ = averaged_log(0.0)
    np.testing.assert_allclose(apart.standard_errors, together.standard_errors, rtol=0.1)


def test_stated_errors_explain_what_the_calibration_leaves():
    together, apart, *_ = averaged_log(1e-3)
    before, after = (calibrate_free(rows, quadratic=False).fit for rows in (together, apart))
    assert before.chi2 < 0.2 * before.dof
    assert 0.3 < after.chi2 / after.dof < 2.0


def test_three_sensors_that_always_lie_alike_cannot_be_are_separable():
    up = np.tile(unit(np.array([1.0, 2.0, 3.0])), (POSES, 1))
    z = np.random.default_rng(1).standard_normal((POSES, BLOCKS - 1, 3))
    response = np.tile(G * tangents(up[:1]), (POSES, 1, 1))
    z = z + (response[:, None] @ np.random.default_rng(2).standard_normal((POSES, BLOCKS - 1, 2, 1)))[..., 0]
    least = np.zeros((POSES, 3))
    waves = Waves(z, np.full(POSES, STILL), least, least)
    found = errors_of_means(waves, response)
    assert found.tilt is None
    np.testing.assert_array_equal(found.alone, np.sqrt(rest_noise(waves, STEADY).variance))


def test_waves_are_weighed_by_what_no_tilt_explains():
    """Compared with dense matrices."""
    rng = np.random.default_rng(0)
    z, S = rng.standard_normal((2, 4, 5)), rng.uniform(0.5, 2.0, (2, 4, 5))
    L = rng.standard_normal((2, 5, 2))
    found = weighed(z, S, Tilting(L, 3))
    D = np.linalg.inv(np.diag(S[1, 2]))
    P = D - D @ L[1] @ np.linalg.inv(L[1].T @ D @ L[1]) @ L[1].T @ D
    np.testing.assert_allclose(found.pull[1, 2], P @ z[1, 2])
    np.testing.assert_allclose(found.left[1, 2], np.diag(P))
    np.testing.assert_allclose(found.pull[1, 3], z[1, 3] / S[1, 3])
    grams = [np.linalg.slogdet(L[r].T @ np.diag(1 / S[r, k]) @ L[r])[1] for r in range(2) for k in range(3)]
    assert found.log == pytest.approx(np.log(S).sum() + sum(grams))


def test_a_session_file_carries_the_tilt():
    _, apart, *_ = averaged_log(1e-3)
    again = read_session(session_document(apart))
    np.testing.assert_allclose(again.tilt_error, apart.tilt_error, rtol=1e-6)


def test_a_raw_log_states_no_tilt():
    document = raw_log(3, orientations=4, still=20)
    document["table"]["tilt_se_deg"] = [0.1] * len(document["table"]["A1"])
    with pytest.raises(FormatError, match="belong to averaged readings"):
        read_session(document)


def test_stated_directions_are_no_better_than_the_tilt():
    up = np.vstack([np.eye(3), -np.eye(3)])
    log, *_ = tilted_log(0.0, directions=up, poses=6)
    rows = average(replace(log, directions=np.repeat(up, STILL, axis=0), direction_sigma=1e-3), residual_per_freedom)
    sigma = [calibrate(replace(rows, tilt_error=tilt)).sensors[0].axis_sigma for tilt in (None, np.full(6, 2e-3))]
    assert sigma[1] == pytest.approx(np.sqrt(5) * sigma[0], rel=0.1)


def test_on_a_stand_the_tilt_is_noise_of_every_reading():
    session = read_session(accelerometer_block(3))
    stated = replace(session, tilt_error=np.full(len(session.readings), 1e-3))
    before, after = (calibrate(s).sensors[0] for s in (session, stated))
    assert after.bias.sigma > 3 * before.bias.sigma


def test_readings_that_never_change_have_no_error_and_no_tilt():
    still, up = np.zeros((12, BLOCKS - 1, 4)), unit(np.random.default_rng(0).standard_normal((12, 3)))
    response = np.random.default_rng(1).standard_normal((4, 3)) @ tangents(up)
    found = errors_of_means(Waves(still, np.full(12, 160), np.zeros((12, 4)), np.zeros((12, 4))), response)
    assert not found.alone.any()
    assert found.tilt is None
