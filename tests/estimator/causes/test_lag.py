"""Lag behind the temperature: the exact answers to a ramp and a step, its limits, and the cause that is named."""

import numpy as np
import pytest

from estimator import diagnose
from estimator.causes.lag import lagging
from estimator.session import ACCELEROMETER
from tests.estimator.causes.hiding import SENSOR, found, scene, spoilt

TIME = np.linspace(0.0, 3000.0, 31)


def test_behind_a_ramp_it_is_late_by_the_time_constant() -> None:
    late = lagging(20 + 0.01 * TIME, TIME, 300.0)
    np.testing.assert_allclose(late, 20 + 0.01 * (TIME - 300.0 * (1 - np.exp(-TIME / 300.0))), atol=1e-12)


def test_after_a_rise_it_settles_exponentially() -> None:
    late = lagging(np.where(TIME > 0, 21.0, 20.0), TIME, 500.0)
    gap = 21.0 - late[1:]
    np.testing.assert_allclose(gap[1:] / gap[:-1], np.exp(-100.0 / 500.0), rtol=1e-12)


def test_a_short_time_constant_leaves_the_temperature_itself() -> None:
    wave = np.sin(TIME / 400.0)
    np.testing.assert_allclose(lagging(wave, TIME, 1e-3), wave, atol=1e-4)


def test_warming_and_cooling_pass_one_temperature_with_two_zeros() -> None:
    up_and_down = 10 - np.abs(TIME - 1500.0) / 150.0
    late = lagging(up_and_down, TIME, 400.0)
    assert late[7] < up_and_down[7] == up_and_down[23] < late[23]


def test_in_no_time_nothing_changes() -> None:
    late = lagging(np.array([0.0, 1.0, 5.0, 5.0]), np.array([0.0, 10.0, 10.0, 20.0]), 10.0)
    assert late[1] == late[2] < late[3] < 5.0


def test_the_hidden_time_constant_is_found() -> None:
    (finding,) = found("thermal-lag").findings
    assert finding.sensors == (f"A{SENSOR + 1}",)
    assert finding.nonlinear["s"] == pytest.approx(900.0, rel=0.2)


@pytest.mark.slow
@pytest.mark.parametrize("simple", ["bias-temperature", "temperature-rate"])
def test_a_zero_that_follows_the_temperature_at_once_is_not_called_late(simple: str) -> None:
    where = scene(ACCELEROMETER, 0)
    for seed in range(3):
        session = spoilt(simple, where.measured(seed), where, np.random.default_rng(seed))
        assert diagnose(session).findings[0].cause == simple
