"""The closed form, and what the published one gets wrong."""

from dataclasses import replace

import numpy as np
import pytest

from estimator import StandErrors, calibrate
from estimator.applied_vector import stand_geometry
from estimator.calibration.analytic import closed_form, linear_start
from estimator.forward import measured
from estimator.parameters import SensorParameters, nominal
from estimator.session import Array, CalibrationSession
from estimator.simulate import simulate
from tests.builders import GRAVITY
from tests.estimator.calibration.cases import CASES, STAND, Case, accelerometers, block, errors

PAIRED = [case for case in CASES if case.on_stand and case.name != "one-run"]


def perfect(schedule: CalibrationSession) -> CalibrationSession:
    """The schedule on a stand without errors, sensors without variation of zero."""
    sensors = tuple(replace(s, bias_repeatability=0.0) for s in schedule.sensors)
    return replace(schedule, sensors=sensors, stand=replace(STAND, sigma=StandErrors()))


def of_session(session: CalibrationSession) -> SensorParameters:
    """The closed form of one session."""
    base, size = nominal(session.sensors), stand_geometry(session).norm
    found = closed_form(measured(session)[0], session, base, size)
    assert found is not None
    return found


@pytest.mark.parametrize("case", [c for c in PAIRED if c.name != "gyro-pulses"], ids=lambda c: c.name)
def test_closed_form_is_exact_without_noise(case: Case) -> None:
    schedule = perfect(replace(case.schedule, count_time=None))
    found = of_session(simulate(schedule, case.truth, np.random.default_rng(0), noise=0.0))
    assert np.allclose(found.scale, case.truth.scale, rtol=1e-11)
    assert np.allclose(found.bias / case.norm, case.truth.bias / case.norm, atol=1e-11)
    assert np.allclose(found.quadratic * case.norm, case.truth.quadratic * case.norm, atol=1e-11)
    assert np.allclose(found.axis, case.truth.axis, atol=1e-11)


@pytest.mark.parametrize("case", PAIRED, ids=lambda c: c.name)
def test_closed_form_equals_the_refinement_within_noise(case: Case) -> None:
    session = case.simulated(1)[0]
    found, result = of_session(session), calibrate(session)
    difference = errors(result, found) / np.sqrt(np.diagonal(result.covariance))
    assert np.sqrt(np.mean(difference**2)) < 1.0
    assert np.abs(difference).max() < 5.0


@pytest.mark.parametrize("positions", [12, 24, 36])
def test_the_printed_matrix_26_has_rank_four(positions: int) -> None:
    beta, C = 2 * np.pi * np.arange(positions) / positions, GRAVITY * np.cos(np.radians(40))
    n1, n3 = -C * np.sin(beta), C * np.cos(beta)
    printed = np.column_stack([np.ones(positions), n1, n3, n1**2, n3**2])
    assert np.linalg.matrix_rank(printed) == 4
    assert np.linalg.cond(printed) > 1e15
    corrected = np.column_stack([np.ones(positions), n1, n3, n1**2 - n3**2])
    assert np.linalg.cond(corrected) < 100


def noiseless(schedule: CalibrationSession, axis: Array) -> CalibrationSession:
    """Noiseless readings of a block whose first sensor points along ``axis`` (platform), with b = 0.01, c = 1e-4."""
    base = nominal(schedule.sensors)
    axes = base.axis.copy()
    axes[0] = schedule.mounting @ axis
    truth = replace(base, axis=axes, bias=base.bias + 0.01, quadratic=base.quadratic + 1e-4)
    return simulate(schedule, truth, np.random.default_rng(0), noise=0.0)


def test_quadratic_survives_where_the_printed_25_divides_by_zero() -> None:
    axis = np.array([0.0, 0.6, 0.8])
    found = of_session(noiseless(perfect(block(accelerometers())), axis))
    assert found.quadratic[0] == pytest.approx(1e-4, rel=1e-9)


def test_four_faces_are_enough() -> None:
    found = of_session(noiseless(perfect(block(accelerometers(), 4)), np.array([0.8, 0.6, 0.0])))
    assert found.quadratic[0] == pytest.approx(1e-4, rel=1e-9)
    assert found.bias[0] == pytest.approx(0.01, rel=1e-9)


def test_one_run_has_no_closed_form() -> None:
    session = block(accelerometers(), runs=(False,))
    assert closed_form(session.readings, session, nominal(session.sensors), np.full(6, GRAVITY)) is None


def test_too_few_positions_have_no_closed_form() -> None:
    session = block(accelerometers(), 2)
    assert closed_form(session.readings, session, nominal(session.sensors), np.full(6, GRAVITY)) is None


def test_linear_start_puts_an_unknown_offset_to_the_bias() -> None:
    session = perfect(block(accelerometers(), runs=(False,)))
    base = nominal(session.sensors)
    truth = replace(base, bias=np.full(6, 20.0))
    readings = simulate(session, truth, np.random.default_rng(0), noise=0.0).readings
    start = linear_start(readings, stand_geometry(session).n, np.full(6, GRAVITY), base)
    assert np.allclose(start.bias, 20.0, rtol=1e-4)
    assert np.allclose(start.axis, base.axis, atol=1e-4)


@pytest.mark.parametrize("runs", [(False, True), (False,)])
def test_a_dead_sensor_is_not_observable_and_spoils_no_other(runs: tuple[bool, ...]) -> None:
    schedule = block(accelerometers(), runs=runs)
    whole = simulate(schedule, nominal(schedule.sensors), np.random.default_rng(0), noise=3e-6)
    readings = whole.readings.copy()
    readings[:, 2] = 1.25
    result, healthy = calibrate(replace(whole, readings=readings)), calibrate(whole)
    assert not any(result.sensors[2].observable.values())
    assert result.sensors[2].known == ()
    assert result.fit.p_value > 1e-3
    assert [s.observable for s in result.sensors if s.name != "A3"] == [
        s.observable for s in healthy.sensors if s.name != "A3"
    ]
