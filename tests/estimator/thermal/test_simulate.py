"""Simulated and planned sessions over temperature."""

from dataclasses import replace

import numpy as np
import pytest

from estimator import calibrate, read_session
from estimator.parameters import SensorParameters
from estimator.session import THERMAL, CalibrationSession
from estimator.thermal.plan import expected
from estimator.thermal.simulate import ThermalLaw, over_temperature, thermal_schedule, usual_law
from tests.estimator.thermal.physics import G, Still, lived

RNG = np.random.default_rng


def session(case: Still) -> CalibrationSession:
    return read_session(lived(case, RNG(1))[0])


def test_readings_at_a_temperature_are_those_of_scale_and_bias_there() -> None:
    """u = u₀ + K·κ·(a + b + Δb), by the law of each sensor."""
    one = session(Still(soaks=(20.0, 70.0), each=6, offset=0.4))
    K, a = np.full(6, 0.12), np.linspace(-G, G, 12)[:, None] * np.ones(6)
    truth = SensorParameters(K, np.full(6, 0.02), np.zeros(6), np.eye(3)[[0, 1, 2] * 2])
    cold = replace(one, readings=0.4 + K * (a + 0.02), standard_errors=np.full((12, 6), 1e-3))
    law = ThermalLaw(np.array([[1e-4, 2e-6]] * 6), np.array([[3e-4, -1e-6]] * 6))
    moved = over_temperature(cold, truth, law)
    assert one.temperature is not None
    t = (one.temperature - 20)[:, None]
    kappa, more = 1 + 1e-4 * t + 2e-6 * t**2, 3e-4 * t - 1e-6 * t**2
    assert moved.readings == pytest.approx(0.4 + K * kappa * (a + 0.02 + more))
    assert moved.standard_errors == pytest.approx(1e-3 * kappa * np.ones(6))


def test_orientations_are_repeated_at_every_soak_two_minutes_a_row_and_an_hour_between() -> None:
    still = session(Still(soaks=(20.0, 70.0), each=6, known=1e-3))
    soaked = thermal_schedule(still, RNG(1), (20.0, -40.0, 60.0))
    assert soaked.programme == THERMAL
    assert soaked.readings.shape == (36, 6)
    assert not soaked.readings.any()
    assert soaked.directions is not None
    assert still.directions is not None
    assert soaked.directions[12:24] == pytest.approx(still.directions)
    assert soaked.time is not None
    assert np.diff(soaked.time)[[0, 10, 11, 12, 23]] == pytest.approx([120, 120, 3720, 120, 3720])
    assert soaked.temperature is not None
    away = soaked.temperature - np.repeat([20.0, -40.0, 60.0], 12)
    assert 0.1 < np.std(away) < 0.3
    usual = thermal_schedule(still, RNG(1)).temperature
    assert usual is not None
    assert (usual.min(), usual.max()) == pytest.approx((-40, 70), abs=1)


def test_usual_sensors_move_by_a_milligravity_and_two_parts_in_a_thousand_over_fifty_degrees() -> None:
    sensors = session(Still(gyros=3)).sensors
    many = (*sensors[:1] * 4000, *sensors[-1:] * 4000)
    law = usual_law(many, RNG(2))
    span = np.array([50.0, 2500.0])
    assert np.std(law.bias[:4000] * span, axis=0) == pytest.approx([1e-3 * G, 5e-4 * G], rel=0.06)
    assert np.std(law.bias[4000:] * span, axis=0) == pytest.approx(np.radians([0.02, 0.01]), rel=0.06)
    assert np.std(law.scale[:4000] * span, axis=0) == pytest.approx([2e-3, 5e-4], rel=0.06)
    assert not law.scale[4000:].any()
    assert abs(np.corrcoef(law.scale[:4000, 0], law.bias[:4000, 0])[0, 1]) < 0.1


def test_a_plan_tells_the_bands_that_a_session_will_have() -> None:
    case = Still(soaks=(20.0, -40.0, 0.0, 45.0, 70.0), each=14, known=2e-3, quadratic=0.0)
    one = session(case)
    told = expected(one, 1e-3 * case.scale)
    real = calibrate(one, quadratic=False)
    assert told.thermal is not None
    assert real.thermal is not None
    for i in range(6):
        planned, found = (c.thermal.sensor(f"A{i + 1}").bias for c in (told, real) if c.thermal)
        assert planned.order == 3
        assert planned.covariance[0, 0] >= 0.99 * found.covariance[0, 0]
        assert planned.covariance[0, 0] < 2 * found.covariance[0, 0]
        assert told.sensor(f"A{i + 1}").axis_covariance == pytest.approx(
            real.sensor(f"A{i + 1}").axis_covariance, rel=0.1, abs=1e-9
        )
    assert not told.sensor("A1").observable["quadratic"]
    assert told.thermal.findings == ()
    assert calibrate(one).sensor("A1").observable["quadratic"]
