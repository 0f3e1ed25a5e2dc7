"""Sessions between which the block was turned: seen in one frame, by an exact rotation."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy import stats
from scipy.spatial.transform import Rotation

from estimator import CalibrationSession, Diagnosis, diagnose
from estimator.causes.fixture import RemountRotation
from estimator.diagnosis.residuals.common_start import baselines
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.residuals.turns import in_frame_of, turned_baseline, turns_between
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.parameters import SensorParameters
from estimator.session import ACCELEROMETER, Array
from estimator.simulate import simulate
from tests.builders import GRAVITY
from tests.estimator.calibration.cases import sphere
from tests.estimator.causes.hiding import scene
from tests.estimator.health.test_common_motion import turned_by

WHERE = scene(ACCELEROMETER, 2)
SESSION, TRUTH = WHERE.world.session, WHERE.world.truth
TURN = turned_by(5.0, 1)


def matrix(vector: Array) -> Array:
    """(3, 3) matrix of a rotation vector, rad."""
    return np.asarray(Rotation.from_rotvec(vector).as_matrix())


def moved(turn: Array, alone: float = 0.0) -> SensorParameters:
    """The truth with the block turned, and A3 turned alone by so much, rad."""
    axis = TRUTH.axis @ matrix(turn).T
    axis[2] = matrix(alone * np.cross(axis[2], [0.6, 0.0, 0.8])) @ axis[2]
    return replace(TRUTH, axis=axis)


def measured(seed: int, turn: Array, alone: float = 0.0, session: CalibrationSession = SESSION) -> CalibrationSession:
    """A session of the block turned by a rotation vector, rad."""
    return simulate(session, moved(turn, alone), np.random.default_rng([30, seed]), noise=WHERE.noise)


@cache
def named(seed: int, alone: float = 0.0) -> Diagnosis:
    """A session of the block turned by five degrees about any axis since two others."""
    history = [measured(10 * seed + k, np.zeros(3)) for k in (1, 2)]
    return diagnose(measured(10 * seed, turned_by(5.0, seed), alone), history)


def test_a_baseline_turned_into_another_frame_leaves_the_same_residuals() -> None:
    here = baseline_of(measured(1, np.zeros(3)))
    there = turned_baseline(here, matrix(TURN))
    assert WhitenedResiduals.of(there).z == pytest.approx(WhitenedResiduals.of(here).z, abs=1e-9)
    assert baseline_of(there.session).parameters.axis == pytest.approx(there.parameters.axis, abs=1e-10)


@pytest.mark.parametrize("alone", [0.0, 0.02])
def test_the_turn_between_two_sessions_is_found_though_one_sensor_moved_alone(alone: float) -> None:
    now, earlier = (baseline_of(s) for s in (measured(1, TURN, alone), measured(2, np.zeros(3))))
    apart = Rotation.from_matrix(turns_between([now], [earlier])[0] @ matrix(TURN).T).as_rotvec()
    assert np.linalg.norm(apart) < 5e-5


@pytest.mark.parametrize("turn", [np.zeros(3), TURN])
def test_a_turned_block_answers_to_a_little_more_turn_as_its_derivative_says(turn: Array) -> None:
    """Central differences of the readings' vector e·n with e = exp(k×)·e0."""
    n, step = GRAVITY * sphere(20), 1e-6
    setting = replace(baseline_of(measured(1, np.zeros(3))).setting, n=n[:, None, :], turn=turn)
    rise = [[n @ matrix(turn + s * k) @ TRUTH.axis.T for k in np.eye(3)] for s in (step, -step)]
    now = TRUTH.axis @ matrix(turn).T
    told = np.einsum("mk,rmkq->rmq", now, np.broadcast_to(RemountRotation().change(setting), (20, 6, 3, 3)))
    assert told == pytest.approx(np.moveaxis(np.subtract(rise[0], rise[1]) / (2 * step), 0, -1), abs=1e-6)


@pytest.mark.parametrize("seed", range(1, 5))
def test_a_block_turned_by_degrees_is_named_as_turned_and_nothing_else(seed: int) -> None:
    (finding,) = named(seed).findings
    pull = (np.array(finding.amplitude) - turned_by(5.0, seed)) / finding.sigma
    assert finding.cause == "remount-rotation"
    assert np.abs(pull).max() < stats.norm.isf(1e-4 / 2)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(1, 5))
def test_a_sensor_that_turned_alone_beside_the_block_is_named_alone(seed: int) -> None:
    found = {f.cause: f.sensors for f in named(seed, 6e-5).findings}
    assert found == {"remount-rotation": (), "sensor-drift": ("A3",)}


def test_the_extended_calibration_has_the_axes_of_before_the_turn() -> None:
    found = named(1).calibration
    error = np.array([s.axis for s in found.sensors]) - TRUTH.axis
    sigma = np.array([s.axis_sigma for s in found.sensors])
    assert (np.linalg.norm(error, axis=1) / sigma).max() < 4
    scales = np.array([(s.scale.value, s.scale.sigma) for s in found.sensors])
    assert (np.abs(scales[:, 0] - TRUTH.scale) / scales[:, 1]).max() < 4


def test_sessions_of_one_mounting_share_the_turn_of_the_latest() -> None:
    now = baseline_of(measured(1, TURN))
    found = in_frame_of(now, [baseline_of(measured(k, np.zeros(3))) for k in (2, 3)])
    assert [f.sits_otherwise for f in found] == [False, False]
    assert found[0].turn == pytest.approx(found[1].turn)


def test_histories_of_different_mountings_are_seen_in_one_frame_and_the_turn_is_since_the_latest() -> None:
    turns = [turned_by(3.0, 5), turned_by(4.0, 6), np.zeros(3)]
    history = [measured(40 + k, turn) for k, turn in enumerate(turns)]
    _, framed = baselines(baseline_of(measured(50, TURN)), [baseline_of(h) for h in history])
    assert [h.sits_otherwise for h in framed] == [True, True, False]
    (finding,) = diagnose(measured(50, TURN), history).findings
    assert finding.cause == "remount-rotation"
    assert np.abs((np.array(finding.amplitude) - TURN) / finding.sigma).max() < 4


def test_a_single_run_that_leaves_a_direction_open_is_no_drift_when_the_block_was_turned() -> None:
    whole = measured(1, TURN)
    assert whole.flipped is not None
    rows = ("readings", "standard_errors", "flipped", "beta", "time", "temperature", "vibration")
    single = replace(whole, **{name: getattr(whole, name)[~whole.flipped] for name in rows})
    found = diagnose(single, [measured(2, np.zeros(3)), measured(3, np.zeros(3))])
    assert {f.cause for f in found.findings} == {"remount-rotation"}


@pytest.mark.parametrize("sensor", [0, 1, 2])
def test_a_session_with_a_reversed_sensor_does_not_spoil_the_fit_of_another(sensor: int) -> None:
    """A fit that starts at the other sign of a sensor leaves its session's own minimum; the session's own is kept."""
    wrong = measured(2, np.zeros(3))
    readings = wrong.readings.copy()
    readings[:, sensor] *= -1
    before = [baseline_of(s) for s in (measured(1, np.zeros(3)), replace(wrong, readings=readings))]
    now, (earlier,) = baselines(before[0], before[1:])
    after, own = ([float(np.mean(b.residual**2 / b.variance)) for b in fits] for fits in ((now, earlier), before))
    assert after == pytest.approx(own, rel=0.1)
