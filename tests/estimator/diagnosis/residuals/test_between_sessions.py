"""What moved since the history, and slips of the record, told from axes that are far from where they were."""

from dataclasses import replace

import numpy as np
import pytest
from estimator.diagnosis.record.errors import exchanged_rows, expected_axes, turned_record

from estimator import CalibrationSession, diagnose, read_session
from estimator.causes import CATALOGUE, Correction, cause
from estimator.diagnosis.residuals.between_sessions import between_sessions, inverse_root
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.residuals.whitened import Evidence
from estimator.diagnosis.signatures.lasting import before
from estimator.session import ACCELEROMETER
from tests.builders import arbitrary_orientations, true_sensors
from tests.estimator.causes.hiding import found, scene, scene_for, with_readings

WHERE = scene(ACCELEROMETER, 2)
SLIPS = [c for c in CATALOGUE if isinstance(c, Correction)]
TURNED = [c for c in SLIPS if c.between]


def test_without_a_move_the_whitened_deviation_is_white() -> None:
    energy, count = 0.0, 0
    for seed in range(8):
        moved = between_sessions(baseline_of(WHERE.measured(seed)), [baseline_of(h) for h in WHERE.earlier(seed)])
        energy, count = energy + float(moved.deviation @ moved.deviation), count + len(moved.deviation)
    assert abs(energy / count - 1) < 4 * np.sqrt(2 / count)


def test_a_move_shows_in_its_own_sigmas() -> None:
    now, history = baseline_of(WHERE.measured(1)), [baseline_of(h) for h in WHERE.earlier(1)]
    moved = between_sessions(now, history)
    step = np.zeros(30)
    step[6] = 1e-4
    covariance = np.linalg.inv(moved.response.T @ moved.response)
    assert np.linalg.norm(moved.response @ step) == pytest.approx(np.sqrt(step @ np.linalg.solve(covariance, step)))


def test_an_inverse_root_leaves_out_directions_without_variance() -> None:
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    root = inverse_root(turn @ np.diag([4.0, 9.0, 0.0]) @ turn.T)
    assert np.linalg.matrix_rank(root, tol=1e-6) == 2


def test_no_history_is_no_move() -> None:
    assert between_sessions(baseline_of(WHERE.measured(1)), []) is None


@pytest.mark.parametrize("slip", TURNED, ids=lambda c: c.identifier)
def test_a_turned_record_is_found_and_put_right(slip: Correction) -> None:
    session = WHERE.measured(1)
    place, wrong = list(slip.corrected(session))[-1]
    undone = turned_record(wrong, baseline_of(wrong), expected_axes([], wrong), SLIPS)
    assert undone is not None
    assert (undone.cause.identifier, undone.places) == (slip.identifier, place)
    assert np.array_equal(undone.session.readings, session.readings)


def test_exchanged_rows_are_found_and_put_right() -> None:
    session = WHERE.measured(1)
    (rows,) = [c for c in SLIPS if not c.between]
    place, wrong = list(rows.corrected(session))[100]
    undone = exchanged_rows(baseline_of(wrong), SLIPS)
    assert undone is not None
    assert undone.places == place


def test_a_sound_record_is_left_alone() -> None:
    session = WHERE.measured(1)
    baseline = baseline_of(session)
    assert turned_record(session, baseline, expected_axes([], session), SLIPS) is None
    assert exchanged_rows(baseline, SLIPS) is None


@pytest.mark.parametrize("cause", ["remount-rotation", "gravity-entry", "alpha-entry"])
def test_a_common_move_is_no_drift_of_a_sensor(cause: str) -> None:
    assert "sensor-drift" not in {f.cause for f in found(cause).findings}


def test_slips_do_not_hide_an_effect() -> None:
    where = scene_for("bias-jump")
    session = where.measured(1)
    jump = 0.12 * 2e-3 * (np.arange(48) >= 20)[:, None] * np.eye(6)[2]
    _, wrong = next(iter(TURNED[0].corrected(with_readings(session, jump))))
    names = [f.cause for f in diagnose(wrong).findings]
    assert names == [TURNED[0].identifier, "bias-jump"]


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


def reordered(session: CalibrationSession, rows: np.ndarray) -> CalibrationSession:
    """The session with its positions measured in another order, at the same moments."""
    return replace(
        session,
        readings=session.readings[rows],
        standard_errors=session.standard_errors[rows],
        beta=session.beta[rows],
        flipped=session.flipped[rows],
    )


def test_a_lasting_effect_that_another_schedule_absorbed_otherwise_is_foretold() -> None:
    """In order around the circle a ramp passes for a tilt of the axis; in a random order it does not."""
    plain = WHERE.measured(1)
    around = np.lexsort((plain.beta, plain.flipped))
    ramp = cause("bias-ramp")
    added = 0.12 * 3e-6 * (plain.time - plain.time.mean())[:, None] * np.eye(6)[2]
    now = baseline_of(with_readings(reordered(plain, around), added))
    past = [baseline_of(with_readings(h, added)) for h in WHERE.earlier(1)]
    moved = between_sessions(now, past)
    evidence = Evidence.of(now, moved)
    (shape,) = [s for s in ramp.shapes(now.setting) if s.sensors == (2,)]
    foretold = evidence.trace(shape.columns, before(evidence, ramp, [shape]))[evidence.readings :, 0] * 3e-6
    assert np.linalg.norm(moved.deviation) > 30
    assert np.linalg.norm(moved.deviation - foretold) < 3 * np.sqrt(len(foretold))
