"""A recording's result in the terms of a calibration."""

from functools import cache

import numpy as np
import pytest

from estimator.parity import ParityResult, parity_check
from estimator.parity.as_calibration import parity_calibration
from estimator.results import Calibration, SensorCalibration
from tests.estimator.parity.cases import biased, block, recording


@cache
def given() -> tuple[ParityResult, Calibration, Calibration]:
    """A recording's result, its calibration and the reference; the third zero has moved."""
    true, reference = block(6)
    found = parity_check(recording(biased(true, 2, 5e-3), seconds=120.0), reference)
    return found, parity_calibration(found, reference), reference


def third() -> tuple[SensorCalibration, SensorCalibration]:
    """The sensor by the recording, and by the reference."""
    _, moved, reference = given()
    return moved.sensor("A3"), reference.sensor("A3")


def test_a_bias_is_the_reference_s_and_its_change() -> None:
    now, then = third()
    change = given()[0].sensor("A3").bias
    assert (now.bias.value, now.bias.sigma) == ((then.bias.value or 0) + (change.size or 0), change.sigma)


def test_a_scale_moves_by_its_relative_change() -> None:
    now, then = third()
    change = given()[0].sensor("A3").scale
    assert now.scale.value == pytest.approx((then.scale.value or 0) * (1 + (change.size or 0)))
    assert now.scale.sigma == pytest.approx((then.scale.value or 0) * (change.sigma or 0))


def test_an_axis_stays_of_length_one_and_turns_by_its_change() -> None:
    now, then = third()
    assert now.axis is not None
    assert np.linalg.norm(now.axis) == pytest.approx(1.0, abs=1e-12)
    assert then.axis_tangents.T @ now.axis == pytest.approx(given()[0].sensor("A3").axis.change, abs=1e-9)


def test_the_covariance_holds_the_sigmas_in_the_order_of_the_names() -> None:
    _, moved, _ = given()
    sigmas = dict(zip(moved.names, np.sqrt(np.diagonal(moved.covariance)), strict=True))
    now, _ = third()
    assert (sigmas["A3.scale"], sigmas["A3.bias"]) == pytest.approx((now.scale.sigma, now.bias.sigma))
    assert sigmas["A3.axis_1"] ** 2 == pytest.approx(now.axis_covariance[0, 0])


def test_the_units_are_the_reference_s() -> None:
    _, moved, reference = given()
    known = dict(zip(reference.names, reference.units, strict=True))
    assert moved.units == tuple(known[name] for name in moved.names)


def test_the_weakest_bias_is_named_with_its_uncertainty() -> None:
    found, moved, _ = given()
    worst = max(found.sensors, key=lambda s: s.bias.sigma or 0)
    assert moved.fit.weakest == (f"{worst.name}.bias (m/s²)", worst.bias.sigma)
    assert (moved.fit.parameters, moved.fit.rank) == (24, found.dof)


def test_a_parameter_that_leaves_no_trace_is_not_observable() -> None:
    true, reference = block(4)
    found = parity_check(recording(true, seconds=120.0), reference)
    for sensor, shown in zip(parity_calibration(found, reference).sensors, found.sensors, strict=True):
        assert sensor.observable["axis"] == (shown.axis.change is not None)
        assert sensor.quadratic.value is None
