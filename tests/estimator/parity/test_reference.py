"""The reference of a recording: inputs, the vector, and the sensors that take part."""

from dataclasses import replace

import numpy as np
import pytest

from estimator.calibration import calibrate
from estimator.errors import ScheduleError
from estimator.parity.reference import reference_of
from estimator.results import Calibration
from estimator.session import ACCELEROMETER, Sensor
from tests.estimator.calibration.free_sessions import G, session, sphere, truth


def given(m: int = 6, quadratic: float = 1e-4) -> tuple[tuple[Sensor, ...], Calibration]:
    """Sensors with a second-order term, calibrated almost without noise."""
    rng = np.random.default_rng(1)
    measured = session(truth(m, quadratic=quadratic), sphere(60, rng), noise=1e-9, rng=rng)
    return measured.sensors, calibrate(measured, quadratic=True)


def test_inputs_undo_the_calibration_with_its_second_order_term() -> None:
    sensors, calibration = given()
    directions = sphere(5, np.random.default_rng(2))
    reference = reference_of(sensors, calibration, ACCELEROMETER)
    found = reference.inputs(truth(6, quadratic=1e-4).readings(directions))
    assert found == pytest.approx(G * directions @ reference.axes.T, abs=1e-6)


def test_an_offset_of_the_reading_is_taken_off_first() -> None:
    sensors, calibration = given()
    plain = reference_of(sensors, calibration, ACCELEROMETER)
    shifted = reference_of([replace(s, nominal_offset=2.5) for s in sensors], calibration, ACCELEROMETER)
    readings = truth(6, quadratic=1e-4).readings(sphere(3, np.random.default_rng(3)))
    assert shifted.inputs(readings + 2.5) == pytest.approx(plain.inputs(readings))


def test_parity_does_not_see_the_vector_and_the_vector_is_found() -> None:
    reference = reference_of(*given(), ACCELEROMETER)
    vectors = 9.8 * sphere(4, np.random.default_rng(4))
    inputs = vectors @ reference.axes.T
    assert inputs @ reference.parity == pytest.approx(0.0, abs=1e-12)
    assert reference.vector(inputs) == pytest.approx(vectors)


def test_a_sensor_that_the_reference_does_not_know_is_named_with_its_place() -> None:
    sensors, calibration = given()
    with pytest.raises(ScheduleError, match=r"sensors\[2\].name.*A9 is not in the reference"):
        reference_of((sensors[0], replace(sensors[1], name="A9"), *sensors[2:]), calibration, ACCELEROMETER)


def test_four_sensors_are_needed() -> None:
    sensors, calibration = given()
    assert reference_of(sensors[:4], calibration, ACCELEROMETER).parity.shape == (4, 1)
    with pytest.raises(ScheduleError, match="3 accelerometers leave no redundancy"):
        reference_of(sensors[:3], calibration, ACCELEROMETER)


def test_a_sensor_whose_bias_is_not_known_takes_no_part() -> None:
    sensors, calibration = given()
    blind = [replace(s, observable={**s.observable, "bias": s.name != "A2"}) for s in calibration.sensors]
    found = reference_of(sensors, replace(calibration, sensors=tuple(blind)), ACCELEROMETER)
    assert (found.names, found.column.tolist()) == (("A1", "A3", "A4", "A5", "A6"), [0, 2, 3, 4, 5])


def test_a_relative_scale_has_a_relative_covariance() -> None:
    sensors, calibration = given()
    reference = reference_of(sensors, calibration, ACCELEROMETER)
    scale = calibration.sensor("A1").scale
    place = calibration.names.index("A1.scale")
    sigma = np.sqrt(calibration.covariance[place, place])
    assert np.sqrt(reference.covariance[0, 0]) == pytest.approx(sigma / (scale.value or 0))
