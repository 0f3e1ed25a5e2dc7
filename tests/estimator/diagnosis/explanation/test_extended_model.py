"""The extended model: amplitudes and covariance are those of one dense fit of everything together."""

import numpy as np
import pytest

from estimator import Calibration, CalibrationSession, calibrate, calibrate_extended, diagnose
from estimator.session import ACCELEROMETER, Array
from tests.estimator.calibration.bound import Happened, covariance, nudged, readings
from tests.estimator.calibration.cases import Case
from tests.estimator.causes.hiding import change, scene, with_readings
from tests.estimator.causes.physics import ACTED, SENSOR

CAUSE = "cubic-nonlinearity"
ACCEPTED = [(CAUSE, ("A2",))]
WHERE = scene(ACCELEROMETER, 0)
ADDED = change(CAUSE, WHERE)


def hidden(seed: int) -> CalibrationSession:
    """A session with a cubic sensor in it."""
    return with_readings(WHERE.measured(seed), ADDED * WHERE.world.truth.scale)


def amplitude() -> float:
    """The hidden one."""
    world = WHERE.world
    unit = ACTED[CAUSE](world, np.array([1e-6]), SENSOR, ()) - world.inputs(world.vectors())
    return float(1e-6 * np.vdot(unit, ADDED) / np.vdot(unit, unit))


def dense_sigmas() -> Array:
    """(31,) sigmas of all parameters and the amplitude, SI, by numerical derivatives and the covariance of all
    readings.
    """
    world = WHERE.world
    case = Case("hidden", world.session, WHERE.noise)
    case.__dict__["truth"] = world.truth
    steps = np.tile([1e-6 * world.truth.scale[0], 1e-5, 1e-6, 1e-6, 1e-6], 6)
    columns = []
    for k, (sensor, element) in enumerate(np.ndindex(6, 5)):
        moved = (nudged(world.truth, sensor, element, s * steps[k]) for s in (1, -1))
        above, below = (readings(world.session, p, Happened({})) for p in moved)
        columns.append((above - below).ravel() / 2)
    unit = ACTED[CAUSE](world, np.array([1e-6]), SENSOR, ()) - world.inputs(world.vectors())
    columns.append((unit * world.truth.scale).ravel())
    J = np.stack(columns, axis=1)
    scale = np.linalg.norm(J, axis=0)
    found = np.linalg.inv((J / scale).T @ np.linalg.solve(covariance(case), J / scale))
    return np.sqrt(np.diagonal(found)) / scale * np.array([*steps, 1e-6])


def sigmas(result: Calibration) -> Array:
    """(P,)"""
    return np.sqrt(np.diagonal(result.covariance))


def test_the_covariance_is_that_of_one_dense_fit() -> None:
    dense = dense_sigmas()
    diagnosis = diagnose(hidden(1))
    assert np.allclose(sigmas(diagnosis.calibration), dense[:-1], rtol=0.01)
    assert np.isclose(diagnosis.findings[0].sigma[0], dense[-1], rtol=0.01)


@pytest.mark.slow
def test_amplitudes_are_unbiased_and_honest() -> None:
    findings = [diagnose(hidden(seed)).findings[0] for seed in range(14)]
    pulls = [(f.amplitude[0] - amplitude()) / f.sigma[0] for f in findings]
    assert abs(np.mean(pulls)) < 4 / np.sqrt(14)
    assert 0.6 < np.std(pulls) < 1.4


def test_the_extended_calibration_gives_the_parameters_without_the_effect() -> None:
    truth = WHERE.world.truth
    result = diagnose(hidden(1)).calibration.sensor("A2")
    plain = calibrate(hidden(1)).sensor("A2")
    assert abs(result.scale.value - truth.scale[1]) < 4 * result.scale.sigma
    assert abs(plain.scale.value - truth.scale[1]) > 10 * plain.scale.sigma


def test_an_accepted_cause_calibrates_as_the_diagnosis_did() -> None:
    session = hidden(1)
    accepted, diagnosed = calibrate_extended(session, ACCEPTED), diagnose(session).calibration
    for name in ("scale", "bias", "quadratic"):
        ours, theirs = (getattr(c.sensor("A2"), name) for c in (accepted, diagnosed))
        assert ours.value == pytest.approx(theirs.value, rel=1e-9)
        assert ours.sigma == pytest.approx(theirs.sigma, rel=1e-9)


def test_an_accepted_cause_is_fitted_even_where_it_is_not_significant() -> None:
    session = WHERE.measured(1)
    plain, extended = calibrate(session), calibrate_extended(session, ACCEPTED)
    assert extended.sensor("A2").scale.sigma > 1.2 * plain.sensor("A2").scale.sigma
    assert extended.sensor("A1").scale.value == pytest.approx(plain.sensor("A1").scale.value, rel=1e-6)


def test_a_cause_that_the_session_cannot_show_is_left_out() -> None:
    session = WHERE.measured(1)
    extended = calibrate_extended(session, [("bias-ramp", ("Z9",)), ("g-sensitivity", ("A1",))])
    assert np.array_equal(extended.covariance, calibrate(session).covariance)
