"""A calibration applied to readings gives back what the sensors felt, within its stated uncertainty."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from estimator import calibrate, read_session
from estimator.applied_vector import stand_geometry
from estimator.correction import Correction, correction_of
from estimator.forward import response
from estimator.parameters import SensorParameters
from estimator.session import CalibrationSession
from estimator.simulate import draw_stand, scattered, simulate
from tests.builders import (
    GRAVITY,
    Document,
    TrueSensor,
    accelerometer_block,
    arbitrary_orientations,
    directions_on_sphere,
    gyro_block,
    mixed_block,
    true_sensors,
)
from tests.builders import (
    response as reading_of,
)


def made(document: Document) -> tuple[CalibrationSession, Correction]:
    """A session and the correction that it gives."""
    session = read_session(document)
    return session, correction_of(session, calibrate(session))


def applied(session: CalibrationSession) -> float:
    """χ² probability of corrected readings against the vectors that the stand applied."""
    _, correction = session, correction_of(session, calibrate(session))
    [block] = correction.blocks
    geometry = stand_geometry(session)
    left = block.vector(session.readings) - geometry.n[:, 0]
    period = session.count_time or 1.0
    scale = np.array([s.scale for s in block.sensors])
    own = (session.standard_errors / (period * scale)) ** 2  # counts of the test are not rounded
    own = own + np.array([s.bias_repeatability for s in session.sensors]) ** 2
    chi2 = 0.0
    for row, error in enumerate(left):
        turned = geometry.beta[row, 0] * geometry.beta_sigma
        covariance = (block.matrix * own[row]) @ block.matrix.T + np.outer(turned, turned)
        chi2 += float(error @ np.linalg.solve(covariance, error))
    # Five parameters a sensor were fitted to the same readings: three fifteenths of them in these directions.
    return float(stats.chi2.sf(chi2, 3 * len(left) - 15))


@pytest.mark.parametrize("seed", range(1, 6))
def test_readings_of_the_session_become_what_the_stand_applied(seed: int) -> None:
    document = accelerometer_block(positions=24, seed=seed)
    document["sensors"] = [sensor | {"bias_repeatability_m_s2": 0.0} for sensor in document["sensors"]]
    document["stand"]["sigma_arcsec"] |= {"beta": 0.0}
    assert 0.001 < applied(read_session(document)) < 0.999


def test_the_earth_s_rotation_comes_back_from_pulse_counts() -> None:
    document = gyro_block(positions=24)
    document["sensors"] = [sensor | {"bias_repeatability_rad_s": 0.0} for sensor in document["sensors"]]
    document["stand"]["sigma_arcsec"] |= {"beta": 0.0}
    assert 0.001 < applied(read_session(document)) < 0.999


@pytest.mark.parametrize("quadratic", [3e-3, -3e-3, 1e-6, 0.0])
def test_a_quadratic_term_is_inverted_exactly(quadratic: float) -> None:
    true = true_sensors(6, bias=1e-3, tilt=1e-3)
    true = [TrueSensor(s.name, s.axis, s.scale, s.bias, quadratic * (1 + i / 9)) for i, s in enumerate(true)]
    _, correction = made(accelerometer_block(sensors=true, se=1e-11))
    [block] = correction.blocks
    force = 1.5 * GRAVITY * directions_on_sphere(50, seed=8)
    readings = np.column_stack([reading_of(s, force) for s in true])
    assert block.vector(readings) == pytest.approx(force, abs=1e-7)


def test_a_stated_offset_is_taken_off_first() -> None:
    document = accelerometer_block()
    plain = made(document)[1].blocks[0]
    document["sensors"] = [sensor | {"nominal_offset": 2.5} for sensor in document["sensors"]]
    for sensor in document["sensors"]:
        document["table"][sensor["name"]] = [u + 2.5 for u in document["table"][sensor["name"]]]
    session, correction = made(document)
    assert correction.blocks[0].vector(session.readings) == pytest.approx(
        plain.vector(session.readings - 2.5), abs=1e-9
    )


def test_the_stated_uncertainty_is_honest() -> None:
    """Readings without noise at a new attitude: normalised error squared of 300 calibrations of one true block."""
    rng = np.random.default_rng(5)
    schedule = read_session(accelerometer_block(positions=12))
    truth = scattered(schedule.sensors, np.full(6, GRAVITY), rng)
    force = GRAVITY * np.array([0.36, 0.48, 0.8])
    read = response(truth, np.broadcast_to(force, (1, 6, 3)))[0]
    total = 0.0
    for _ in range(300):
        session = simulate(schedule, truth, rng, noise=3e-6, draw=draw_stand(schedule, rng))
        [block] = correction_of(session, calibrate(session)).blocks
        error = block.vector(read) - force
        total += float(error @ np.linalg.solve(block.vector_covariance(read), error))
    low, high = stats.chi2.ppf(np.array([0.001, 0.999]), 900)
    assert low < total < high


def test_each_kind_of_a_mixed_block_has_its_own_matrix() -> None:
    session, correction = made(mixed_block())
    assert [block.kind for block in correction.blocks] == ["accelerometer", "gyroscope"]
    force = correction.blocks[0].vector(session.readings[:, :3])
    assert np.linalg.norm(force, axis=1) == pytest.approx(np.full(len(force), GRAVITY), rel=1e-4)


def test_without_a_stand_the_length_is_gravity() -> None:
    session, correction = made(arbitrary_orientations())
    [block] = correction.blocks
    assert np.linalg.norm(block.vector(session.readings), axis=1) == pytest.approx(np.full(24, GRAVITY), rel=1e-5)


def test_a_sensor_that_is_not_observed_is_left_out_with_its_reason() -> None:
    session = read_session(accelerometer_block())
    calibration = calibrate(session)
    first, *others = calibration.sensors
    blind = replace(first, scale=replace(first.scale, value=None), observable=first.observable | {"scale": False})
    correction = correction_of(session, replace(calibration, sensors=(blind, *others)))
    assert correction.left_out == (("A1", "the session does not observe its scale"),)
    assert [s.name for s in correction.blocks[0].sensors] == ["A2", "A3", "A4", "A5", "A6"]


def test_axes_in_a_plane_give_no_vector() -> None:
    session = read_session(accelerometer_block(3))
    calibration = calibrate(session)
    flat = tuple(replace(s, axis=np.array([np.cos(i), np.sin(i), 0.0])) for i, s in enumerate(calibration.sensors))
    correction = correction_of(session, replace(calibration, sensors=flat))
    assert correction.blocks == ()
    assert [name for name, _ in correction.left_out] == ["A1", "A2", "A3"]


def test_parameters_are_the_calibration_s() -> None:
    session = read_session(accelerometer_block())
    calibration = calibrate(session)
    [block] = correction_of(session, calibration).blocks
    found = SensorParameters(
        scale=np.array([s.scale for s in block.sensors]), bias=np.array([s.bias for s in block.sensors]),
        quadratic=np.array([s.quadratic for s in block.sensors]), axis=np.stack([s.axis for s in block.sensors]),
    )  # fmt: skip
    n = stand_geometry(session).n
    assert block.components(response(found, n)) == pytest.approx(np.einsum("rmk,mk->rm", n, found.axis), abs=1e-9)
