"""Changes since the history: the parameters of earlier sessions as one whitened reference."""

from dataclasses import replace

import numpy as np
import pytest

from estimator import CalibrationSession, diagnose, read_session
from estimator.diagnosis.residuals.between_sessions import inverse_root, parameter_change
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.session import ACCELEROMETER
from tests.builders import arbitrary_orientations, true_sensors
from tests.estimator.causes.hiding import found, scene, with_readings

WHERE = scene(ACCELEROMETER, 2)


def test_without_a_move_the_whitened_deviation_is_white() -> None:
    energy, count = 0.0, 0
    for seed in range(8):
        moved = parameter_change(baseline_of(WHERE.measured(seed)), [baseline_of(h) for h in WHERE.earlier(seed)])
        energy, count = energy + float(moved.deviation @ moved.deviation), count + len(moved.deviation)
    assert abs(energy / count - 1) < 4 * np.sqrt(2 / count)


def test_a_move_shows_in_its_own_sigmas() -> None:
    now, history = baseline_of(WHERE.measured(1)), [baseline_of(h) for h in WHERE.earlier(1)]
    moved = parameter_change(now, history)
    step = np.zeros(30)
    step[6] = 1e-4
    covariance = np.linalg.inv(moved.inverse_root.T @ moved.inverse_root)
    assert np.linalg.norm(moved.inverse_root @ step) == pytest.approx(np.sqrt(step @ np.linalg.solve(covariance, step)))


def test_an_inverse_root_leaves_out_directions_without_variance() -> None:
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    root = inverse_root(turn @ np.diag([4.0, 9.0, 0.0]) @ turn.T)
    assert np.linalg.matrix_rank(root, tol=1e-6) == 2


def test_no_history_is_no_move() -> None:
    assert parameter_change(baseline_of(WHERE.measured(1)), []) is None


@pytest.mark.parametrize("cause", ["remount-rotation", "gravity-entry", "alpha-entry"])
def test_a_common_move_is_no_drift_of_a_sensor(cause: str) -> None:
    assert "sensor-drift" not in {f.cause for f in found(cause).findings}


def test_a_quadratic_term_that_changed_is_structure_of_its_sensor_and_no_cause() -> None:
    session = WHERE.measured(1)
    bent = 2e-5 * session.readings[:, 2] ** 2 / 0.12
    told = diagnose(with_readings(session, bent[:, None] * np.eye(6)[2]), WHERE.earlier(1))
    assert told.findings == ()
    assert [(s.where, s.sensors) for s in told.structures] == [
        ("the sensor's parameters, changed since the earlier sessions", ("A3",))
    ]


@pytest.mark.slow
def test_a_sensor_that_drifted_in_its_quadratic_term_too_has_drifted() -> None:
    session = WHERE.measured(1)
    bent = 3e-4 * session.readings[:, 2] ** 2 / 0.12 + 0.12 * 2e-3
    told = diagnose(with_readings(session, bent[:, None] * np.eye(6)[2]), WHERE.earlier(1))
    assert [(f.cause, f.sensors) for f in told.findings] == [("sensor-drift", ("A3",))]


HAND = true_sensors(6, bias=1e-2, tilt=1e-2)


def by_hand(seed: int, turned: float = 0.0) -> CalibrationSession:
    """A session in arbitrary orientations; the axis of A3 turned by so much, rad."""
    axis = np.array(HAND[2].axis) + turned * np.array([0.0, 0.8, 0.6])
    now = [replace(s, axis=tuple(axis / np.linalg.norm(axis))) if s.name == "A3" else s for s in HAND]
    return read_session(arbitrary_orientations(6, sensors=now, seed=seed))


@pytest.mark.parametrize("seed", range(1, 5))
def test_an_axis_that_turned_alone_is_found_though_the_frame_is_free_to_turn(seed: int) -> None:
    found = diagnose(by_hand(10 * seed, 3.6e-4), history=[by_hand(10 * seed + 1), by_hand(10 * seed + 2)])
    assert [(f.cause, f.sensors) for f in found.findings] == [("sensor-drift", ("A3",))]


@pytest.mark.parametrize("seed", range(1, 5))
def test_a_frame_that_is_free_to_turn_names_nothing_by_itself(seed: int) -> None:
    found = diagnose(by_hand(10 * seed), history=[by_hand(10 * seed + 1), by_hand(10 * seed + 2)])
    assert found.findings == ()
