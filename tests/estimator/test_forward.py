"""The forward model, its Jacobian, and sessions simulated by it."""

from dataclasses import replace

import numpy as np
import pytest

from estimator import Site, StandErrors
from estimator.applied_vector import EARTH_RATE, stand_geometry
from estimator.arrays import tangents
from estimator.forward import jacobian, measured, response, slope
from estimator.parameters import SensorParameters
from estimator.simulate import StandDraw, orientation_schedule, simulate
from tests.builders import GRAVITY
from tests.estimator.calibration.bound import Happened, readings
from tests.estimator.calibration.cases import CASES, Case, accelerometers, gyros, sphere

STAND = [case for case in CASES if case.on_stand]
NO_ERRORS = StandDraw(StandErrors(), np.zeros(24))
MIXED = next(case for case in CASES if case.name == "mixed-counts")


def bent(case: Case) -> SensorParameters:
    """The case's truth with a nonlinearity that shows."""
    return replace(case.truth, quadratic=0.02 / case.norm)


@pytest.mark.parametrize("case", STAND, ids=lambda c: c.name)
def test_response_is_the_convention_pages_equation(case: Case) -> None:
    schedule, truth = replace(case.schedule, count_time=None), bent(case)
    assert np.allclose(response(truth, stand_geometry(schedule).n), readings(schedule, truth, Happened({})), rtol=1e-12)


@pytest.mark.parametrize("case", STAND, ids=lambda c: c.name)
def test_jacobian_is_the_numerical_derivative(case: Case) -> None:
    truth, n, h = bent(case), stand_geometry(case.schedule).n, 1e-5
    found = jacobian(truth, n, case.norm)
    for element in range(5):
        step = np.zeros((len(case.norm), 5))
        step[:, element] = h
        above, below = (response(truth.stepped(s, case.norm), n) / truth.scale for s in (step, -step))
        assert np.allclose(found[..., element], (above - below) / (2 * h), atol=1e-8 * case.norm.max())


def test_slope_is_the_answer_to_a_change_of_input() -> None:
    case = STAND[0]
    truth, n = bent(case), stand_geometry(case.schedule).n
    push = 1e-6 * truth.axis
    change = (response(truth, n + push) - response(truth, n - push)) / (2e-6 * truth.scale)
    assert np.allclose(slope(truth, n), change, rtol=1e-8)


def test_tangents_are_a_right_handed_frame() -> None:
    axes = np.concatenate([np.eye(3), -np.eye(3), sphere(50)])
    frame = np.concatenate([tangents(axes), axes[..., None]], axis=-1)
    assert np.allclose(frame.swapaxes(-1, -2) @ frame, np.eye(3), atol=1e-14)
    assert np.allclose(np.linalg.det(frame), 1.0)


def test_pulse_counts_become_rates_with_their_quantisation() -> None:
    session = MIXED.simulated(1)[0]
    values, errors = measured(session)
    assert np.allclose(values[:, 3:], session.readings[:, 3:] / 100.0)
    assert np.allclose(errors[:, 3:], np.sqrt(1.0 + 1 / 6) / 100.0)
    assert np.allclose(values[:, :3], session.readings[:, :3] - 32768.0)


def test_pulses_are_whole() -> None:
    pulses = MIXED.simulated(1)[0].readings[:, 3:]
    assert np.array_equal(pulses, np.round(pulses))


def test_a_longer_count_time_counts_more() -> None:
    errors = StandErrors(count_time=1.0)
    draws = [StandDraw(e, np.zeros(24)) for e in (StandErrors(), errors)]
    sensors = tuple(replace(s, bias_repeatability=0.0) for s in MIXED.schedule.sensors)
    schedule = replace(MIXED.schedule, sensors=sensors)
    short, long = (simulate(schedule, MIXED.truth, np.random.default_rng(0), noise=0.0, draw=d).readings for d in draws)
    assert np.allclose(long[:, 3:], 1.01 * short[:, 3:], atol=1.1)
    assert np.array_equal(long[:, :3], short[:, :3])


def test_gyros_at_rest_meet_the_earth_rate_at_the_latitude() -> None:
    site = Site(latitude=0.9, gravity=GRAVITY)
    sensors = (*accelerometers(3), *gyros(3, scale=1.0, unit="rad/s"))
    quiet = tuple(replace(s, bias_repeatability=0.0, nominal_axis=np.eye(3)[i % 3]) for i, s in enumerate(sensors))
    schedule = orientation_schedule(quiet, site, sphere(20))
    ones = SensorParameters(np.ones(6), np.zeros(6), np.zeros(6), np.stack([s.nominal_axis for s in quiet]))
    u = simulate(schedule, ones, np.random.default_rng(0), noise=0.0).readings
    assert np.allclose(np.linalg.norm(u[:, 3:], axis=1), EARTH_RATE)
    assert np.allclose((u[:, :3] * u[:, 3:]).sum(axis=1), GRAVITY * EARTH_RATE * np.sin(0.9))


@pytest.mark.parametrize("counter", ["free-running", "reset"])
def test_the_scatter_of_counts_is_the_quantisation_that_is_stated(counter: str) -> None:
    """There is no other noise, and no rate gives a whole number of pulses."""
    steady = tuple(replace(s, bias_repeatability=0.0) for s in MIXED.schedule.sensors)
    schedule = replace(MIXED.schedule, counter=counter, sensors=steady)
    counted = simulate(schedule, MIXED.truth, np.random.default_rng(3), noise=0.0, draw=NO_ERRORS).readings[:, 3:]
    exact = 100.0 * response(MIXED.truth, stand_geometry(schedule).n)[:, 3:]
    spread = np.mean((counted - exact) ** 2)
    assert spread == pytest.approx(schedule.quantisation, rel=0.35)
    assert schedule.quantisation == {"free-running": 1 / 6, "reset": 1 / 12}[counter]


def test_a_mean_of_counts_that_run_on_is_better_than_independent_ones() -> None:
    """The errors of neighbouring counts cancel: only the first and the last reading of the counter are rounded."""
    rng = np.random.default_rng(5)
    rate, begun = rng.uniform(7, 9, (4000, 1)), rng.uniform(0, 1, (4000, 1))
    counts = np.diff(np.floor(rate * np.arange(51) + begun), axis=1)
    session = replace(MIXED.schedule, counts_averaged=np.full(24, 50.0))
    assert np.mean((counts.mean(axis=1) - rate[:, 0]) ** 2) == pytest.approx(np.max(session.quantisation), rel=0.1)
    assert np.mean((counts[:, 0] - rate[:, 0]) ** 2) == pytest.approx(MIXED.schedule.quantisation, rel=0.1)
    assert replace(session, counter="reset").quantisation == 1 / 12
