"""The vector of the nominal numbers, corrected, is what was applied; its covariance is that of what it is made from."""

from dataclasses import replace

import numpy as np
import pytest

from estimator import calibrate, read_session
from estimator.applied_vector import stand_geometry
from estimator.correction import SensorCorrection, correction_of
from estimator.nominal_vector import nominal_vector, nominal_vectors
from estimator.session import Array
from tests.builders import accelerometer_block, gyro_block, true_sensors


@pytest.mark.parametrize("m", [3, 6])
def test_the_corrected_vector_is_the_applied_one(m: int) -> None:
    session = read_session(accelerometer_block(sensors=true_sensors(m, bias=0.05, tilt=0.01), positions=24))
    [block] = correction_of(session, calibrate(session)).blocks
    vectors = nominal_vectors(session, block, session.readings)
    applied, one = stand_geometry(session).n[:, 0], nominal_vector(session, block)
    assert np.abs(vectors - applied).max() > 0.05
    # What is left is the quadratic term's part, and the stand's own error, some arc seconds.
    assert np.abs(one.corrected(vectors) - applied).max() < 2 * one.curvature * 9.82**2 + 5e-4


def test_pulses_are_turned_into_the_earth_s_rotation() -> None:
    session = read_session(gyro_block(positions=24))
    [block] = correction_of(session, calibrate(session)).blocks
    vectors = nominal_vector(session, block).corrected(nominal_vectors(session, block, session.readings))
    assert np.linalg.norm(vectors, axis=1) == pytest.approx(7.292115e-5, rel=2e-2)


def test_its_covariance_is_that_of_what_the_parameters_may_be() -> None:
    session = read_session(accelerometer_block(3, positions=12))
    [block] = correction_of(session, calibrate(session)).blocks
    stated = np.sqrt(np.diag(nominal_vector(session, block).covariance))
    rng = np.random.default_rng(3)
    errors = rng.multivariate_normal(np.zeros(15), block.covariance, size=2000, method="eigh").reshape(2000, 3, 5)
    drawn = [nominal_vector(session, replace(block, sensors=moved(block.sensors, each))) for each in errors]
    numbers = np.array([[*one.correction.ravel(), *one.bias] for one in drawn])
    assert numbers.std(axis=0) / stated == pytest.approx(np.ones(12), abs=0.06)  # 2000 draws tell it to 1.6 %


def moved(sensors: tuple[SensorCorrection, ...], errors: Array) -> tuple[SensorCorrection, ...]:
    """Sensors with other parameters (m, 5): scale, bias, quadratic and the axis along its tangents."""
    return tuple(
        replace(
            sensor,
            scale=sensor.scale + error[0],
            bias=sensor.bias + error[1],
            axis=sensor.axis + sensor.tangents @ error[3:],
        )
        for sensor, error in zip(sensors, errors, strict=True)
    )
