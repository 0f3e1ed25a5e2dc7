"""A cause in the unit of a tolerance: what it does to a zero, a scale factor or a direction over its session."""

from dataclasses import replace

import numpy as np
import pytest

from estimator import calibrate
from estimator.applied_vector import STANDARD_GRAVITY as G
from estimator.causes import CATALOGUE, Cause
from estimator.diagnosis import Finding
from estimator.diagnosis.results import Course, Structure
from estimator.reading import read_session
from service.judging.cause_sizes import ACTS_ON, Yardstick, by_input, size_of_cause, size_of_structure
from tests.builders import accelerometer_block

Names = tuple[str, ...]
TOLERANCES = {("accelerometer", "bias"): 5e-4, ("accelerometer", "scale"): 1e-4, ("accelerometer", "axis"): 1e-4}
CALIBRATION = calibrate(read_session(accelerometer_block()))
RESIDUALS = replace(CALIBRATION.residuals, temperature=20.0 + np.linspace(0.0, 3.0, 24))
BY = Yardstick(CALIBRATION, RESIDUALS, TOLERANCES)
"""24 rows, one a minute; warming by 3 °C."""


def found(cause: str, units: tuple[str, ...], amplitude: tuple[float, ...], sensors: tuple[str, ...]) -> Finding:
    sigma = tuple(abs(a) / 10 for a in amplitude)
    return Finding(cause, "", "", sensors, 1e-9, 9.0, amplitude=amplitude, sigma=sigma, units=units)


@pytest.mark.parametrize(
    ("cause", "units", "amplitude", "sensors", "parameter", "size"),
    [
        ("bias-jump", ("m/s²",), (-4e-4,), ("A2",), "bias", 4e-4),
        ("bias-ramp", ("m/s²/s",), (1e-7,), ("A2",), "bias", 1e-7 * 23 * 60),
        ("bias-temperature", ("m/s²/K",), (1e-4,), ("A2",), "bias", 3e-4),
        ("temperature-rate", ("m/s²/(K/s)",), (1.0,), ("A2",), "bias", 0.0),
        ("scale-asymmetry", ("1",), (5e-5,), ("A2",), "scale", 5e-5),
        ("scale-temperature", ("1/K",), (2e-5,), ("A2",), "scale", 6e-5),
        ("scale-temperature-curve", ("1/K", "1/K²"), (2e-5, 0.0), ("A2",), "scale", 6e-5),
        ("scale-ramp", ("1/s",), (1e-8,), ("A2",), "scale", 1e-8 * 23 * 60),
        ("axis-creep", ("rad/s", "rad/s"), (3e-8, 4e-8), ("A2",), "axis", 5e-8 * 23 * 60),
        ("cubic-nonlinearity", ("(m/s²)⁻²",), (1e-7,), ("A2",), "bias", 1e-7 * G**3),
        ("cross-coupling", ("(m/s²)⁻¹", "(m/s²)⁻¹"), (3e-6, 4e-6), ("A2",), "bias", 5e-6 * G**2),
        ("levelling-y", ("rad",), (7e-5,), (), "axis", 7e-5),
        ("stand-drift", ("rad/s",), (1e-8,), (), "axis", 1e-8 * 23 * 60),
        ("beta-scale", ("1",), (1e-5,), (), "axis", 1e-5 * np.deg2rad(330)),
    ],
)
def test_the_size_is_what_the_session_gave_the_cause_to_act_on(
    cause: str, units: Names, amplitude: tuple[float, ...], sensors: Names, parameter: str, size: float
) -> None:
    got = size_of_cause(found(cause, units, amplitude, sensors), BY)
    assert got is not None
    assert (got.parameter, got.sensors) == (parameter, sensors)
    assert got.value == pytest.approx(size, abs=1e-12)
    assert got.share == pytest.approx(size / got.tolerance, abs=1e-9)


def test_of_several_sensors_the_one_where_it_weighs_most_counts() -> None:
    got = size_of_cause(found("bias-jump", ("m/s²",) * 2, (1e-4, 3e-4), ("A2", "A5")), BY)
    assert got is not None
    assert (got.sensors, got.value, got.sigma) == (("A5",), 3e-4, pytest.approx(3e-5))


@pytest.mark.parametrize(("since", "left"), [(None, 1.0), (0.0, 1.0), (1800.0, np.exp(-2))])
def test_of_what_settles_counts_what_is_left_at_the_first_row(since: float | None, left: float) -> None:
    warm = found("warm-up", ("m/s²",) * 2, (1e-3, 4e-3), ("A2", "A5"))
    got = size_of_cause(replace(warm, nonlinear_each=({"s": 900.0}, {"s": 900.0}), since_power_on=since), BY)
    assert got is not None
    assert (got.sensors, got.value) == (("A5",), pytest.approx(4e-3 * left))
    assert got.sigma == pytest.approx(4e-4 * left)


def test_where_no_tolerance_is_set_nothing_is_large() -> None:
    assert size_of_cause(found("bias-jump", ("m/s²",), (1.0,), ("A2",)), replace(BY, tolerances={})) is None


@pytest.mark.parametrize("cause", CATALOGUE, ids=lambda cause: cause.identifier)
def test_every_unit_of_the_catalogue_is_known(cause: Cause) -> None:
    of_gyros = (unit.replace("m/s²", "rad/s") for unit in cause.units if cause.kind is None)
    assert cause.grows_an_angle or {by_input(unit) for unit in (*cause.units, *of_gyros)} <= set(ACTS_ON)


def test_what_has_no_amplitude_to_go_by_is_sized_by_its_strength() -> None:
    clipped = found("saturation", ("m/s²",), (9.0,), ("A2",))
    got = size_of_cause(clipped, BY)
    rows = RESIDUALS.sigma[:, 1]
    assert got is not None
    assert got.value == pytest.approx(9.0 * np.sqrt(np.mean(rows**2) / len(rows)))


def test_structure_is_sized_by_its_strength_and_a_course_by_what_it_does_to_gravity() -> None:
    own = size_of_structure(Structure("", ("A2",), 1e-9, 9.0), BY)
    course = Course("β", ("α",), tuple((angle,) for angle in (1e-5, -1e-5)))
    common = size_of_structure(Structure("", (), 1e-9, 9.0, course), BY)
    assert own is not None
    assert common is not None
    assert own.value == pytest.approx(9.0 * np.sqrt(np.mean(RESIDUALS.sigma[:, 1] ** 2) / 24))
    assert common.value == pytest.approx(1e-5 * G)
