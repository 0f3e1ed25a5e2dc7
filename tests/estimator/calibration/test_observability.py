"""Parameters that a session does not determine are reported, with the combinations that it does determine."""

from dataclasses import replace

import numpy as np
import pytest

from estimator import calibrate, calibrate_many
from estimator.arrays import unit
from estimator.calibration.stand import solved
from estimator.parameters import SensorParameters, nominal
from estimator.results import KnownCombination
from estimator.session import Array, CalibrationSession
from estimator.simulate import scattered, simulate
from tests.builders import EARTH_RATE, GRAVITY
from tests.estimator.calibration.cases import accelerometers, block, gyros

NOISE = 3e-6
LIFT = GRAVITY * np.sin(np.radians(40.0))


def along_the_head(sign: float) -> tuple[CalibrationSession, SensorParameters]:
    """A block whose first sensor points along the axis of rotation, and its truth."""
    schedule = block(accelerometers())
    sensors = list(schedule.sensors)
    sensors[0] = replace(sensors[0], nominal_axis=schedule.mounting @ np.array([0.0, sign, 0.0]))
    truth = nominal(tuple(sensors))
    bias, quadratic = np.full(6, 0.02), np.full(6, 3e-5)
    return replace(schedule, sensors=tuple(sensors)), replace(truth, bias=bias, quadratic=quadratic)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_an_axis_along_the_head_hides_bias_and_quadratic(sign: float) -> None:
    schedule, truth = along_the_head(sign)
    first = calibrate(simulate(schedule, truth, np.random.default_rng(0), noise=NOISE)).sensors[0]
    assert first.observable == {"scale": True, "bias": False, "quadratic": False, "axis": True}
    assert first.bias.value is None
    assert first.quadratic.sigma is None


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_their_sum_is_known_and_right(sign: float) -> None:
    schedule, truth = along_the_head(sign)
    rng = np.random.default_rng(1)
    results = calibrate_many([simulate(schedule, truth, rng, noise=NOISE) for _ in range(400)])
    known = [r.sensors[0].known[0] for r in results]
    assert known[0].coefficients["bias"] == 1.0
    assert known[0].coefficients["quadratic"] == pytest.approx(LIFT**2, rel=1e-6)
    scaled = [(k.value - (0.02 + k.coefficients["quadratic"] * 3e-5)) / k.sigma for k in known]
    assert np.std(scaled) == pytest.approx(1.0, abs=0.15)
    assert abs(np.mean(scaled)) < 4 / np.sqrt(400)


def test_the_other_sensors_are_not_touched() -> None:
    schedule, truth = along_the_head(1.0)
    result = calibrate(simulate(schedule, truth, np.random.default_rng(0), noise=NOISE))
    assert all(all(s.observable.values()) for s in result.sensors[1:])
    assert np.isnan(np.diagonal(result.covariance)).sum() == 2


@pytest.mark.parametrize("seed", [2, 4, 5])
def test_what_the_rows_hardly_tell_stays_where_it_began(seed: int) -> None:
    """One run of gyros whose noise is 0.2 % of the Earth's rate: of the one near the head two directions stay open."""
    axes = unit(np.array([[-0.2, 0.98, 0.0], [-0.9, -0.3, 0.3], [-0.2, -0.1, -1.0]]))
    sensors = [replace(s, nominal_axis=a) for s, a in zip(gyros(3, scale=1e4, unit="V"), axes, strict=True)]
    schedule = replace(block(tuple(sensors), 14, runs=(False,)), mounting=np.eye(3))
    rng = np.random.default_rng(seed)
    measured = simulate(schedule, nominal(tuple(sensors)), rng, noise=2e-3 * EARTH_RATE * 1e4)
    found = solved([measured]).fitted
    assert found.converged[0]
    assert abs(found.parameters.quadratic[0, 0] * EARTH_RATE) < 1e-3
    assert abs(found.parameters.scale[0, 0] / 1e4 - 1) < 1e-3


def single_run(count: int) -> tuple[SensorParameters, list[tuple[tuple[KnownCombination, ...], ...]]]:
    """Truth, and the known combinations of all sensors in sessions of the direct run alone."""
    schedule = block(accelerometers(), 24, runs=(False,))
    rng = np.random.default_rng(2)
    truth = scattered(schedule.sensors, np.full(6, GRAVITY), rng, quadratic=1e-5)
    results = calibrate_many([simulate(schedule, truth, rng, noise=NOISE) for _ in range(count)])
    return truth, [tuple(s.known for s in r.sensors) for r in results]


def test_one_run_does_not_observe_scale_bias_and_axis() -> None:
    schedule = block(accelerometers(), 24, runs=(False,))
    session = simulate(schedule, nominal(schedule.sensors), np.random.default_rng(0), noise=NOISE)
    for sensor in calibrate(session).sensors:
        assert sensor.observable == {"scale": False, "bias": False, "quadratic": True, "axis": False}


def test_what_one_run_does_know_is_right() -> None:
    truth, known = single_run(300)
    linear = linear_quantities(truth)
    scaled = []
    for session in known:
        for i, combinations in enumerate(session):
            assert len(combinations) == 4
            scaled += [
                (k.value - sum(c * linear[name][i] for name, c in k.coefficients.items())) / k.sigma
                for k in combinations
            ]
    assert np.sqrt(np.mean(np.square(scaled))) == pytest.approx(1.0, abs=0.05)
    assert 0.93 <= np.mean(np.abs(scaled) < 1.96) <= 0.97


def linear_quantities(truth: SensorParameters) -> dict[str, Array]:
    """(m,) each of what a reading is linear in."""
    sensitivity = truth.scale[:, None] * truth.axis
    return {
        "zero_reading": truth.scale * truth.bias,
        "quadratic_reading": truth.scale * truth.quadratic,
    } | {f"sensitivity_{axis}": sensitivity[:, k] for k, axis in enumerate("xyz")}


def test_weakest_direction_names_the_sensor_and_its_element() -> None:
    schedule, truth = along_the_head(1.0)
    fit = calibrate(simulate(schedule, truth, np.random.default_rng(0), noise=NOISE)).fit
    assert fit.weakest[0] in {"A1.bias", "A1.quadratic"}
    assert fit.rank == fit.parameters - 1
