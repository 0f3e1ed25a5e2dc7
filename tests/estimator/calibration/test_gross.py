"""Grossly wrong readings are set aside before the fit; effects and noise are not."""

import json
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from benchmarks.study.seen.gross_sessions import Truth, orientations, stand
from estimator import calibrate, calibrate_many, diagnose, read_session
from estimator.results import Calibration
from estimator.session import CalibrationSession


def drawn(draw=stand, seed=1) -> Truth:
    """A sound session of known truth, its errors stated."""
    return replace(draw(np.random.default_rng(seed)), stated=True)


def with_reading(truth: Truth, row: int, sensor: int, value: float) -> CalibrationSession:
    """The session with one reading changed."""
    readings = truth.readings.copy()
    readings[row, sensor] = value
    return read_session(replace(truth, readings=readings).file())


def places(calibration: Calibration) -> list[tuple[int, str, str]]:
    return [(a.row, a.sensor, a.slip) for a in calibration.set_aside]


@pytest.mark.parametrize("draw", [stand, lambda rng: orientations(rng, triad=False)])
def test_a_zero_is_set_aside_and_the_rest_is_as_without_it(draw) -> None:
    truth = drawn(draw, 3)
    j = int(np.argmax(np.abs(truth.readings[:, 1])))
    sound, wrong = calibrate(read_session(truth.file())), calibrate(with_reading(truth, j, 1, 0.0))
    assert places(wrong) == [(j + 1, truth.names[1], "zero")]
    assert wrong.fit.dof == sound.fit.dof - 1
    for sensor in wrong.sensors:
        before = sound.sensor(sensor.name).scale
        assert sensor.scale.value == pytest.approx(before.value, abs=3 * before.sigma)


def test_slips_are_told_apart() -> None:
    truth = drawn(seed=5)
    right = float(truth.readings[8, 0])
    slips = {
        "sign": -right,
        "decimal-point": 10 * right,
        "row-before": float(truth.readings[7, 0]),
        "neighbour-column": float(truth.readings[8, 2]),
        "unknown": right + 0.317,
    }
    for slip, value in slips.items():
        assert places(calibrate(with_reading(truth, 8, 0, value))) == [(9, truth.names[0], slip)]


def test_a_channel_that_stops_is_one_stretch() -> None:
    truth = drawn(seed=2)
    readings = truth.readings.copy()
    readings[10:14, 2] = readings[9, 2]
    aside = calibrate(read_session(replace(truth, readings=readings).file())).set_aside
    assert [(a.row, a.last_row, a.slip) for a in aside] == [(11, 14, "stuck")]


def test_a_row_of_a_triad_that_cannot_tell_is_left_out_with_its_suspects() -> None:
    truth = drawn(lambda rng: orientations(rng, triad=True), 6)
    inside = (truth.applied**2).max(axis=1)
    j = int(np.argmin(inside))
    [aside] = calibrate(with_reading(truth, j, 0, float(truth.readings[j, 0]) + 0.05)).set_aside
    assert aside.row == j + 1
    assert "A1" in aside.suspects


def test_smooth_effects_of_many_standard_errors_are_left_to_the_diagnosis() -> None:
    truth = drawn(seed=7)
    R = len(truth.readings)
    effects = {
        "jump": 200 * (np.arange(R) > R - 4),
        "warm-up": 300 * np.exp(-np.arange(R) / 2.0),
        "square": 100 * truth.applied[:, 0] ** 2,
        "loop": 20 * np.sign(np.gradient(truth.applied[:, 0])),
    }
    for effect in effects.values():
        readings = truth.readings.copy()
        readings[:, 0] += truth.noise[0] * effect
        assert calibrate(read_session(replace(truth, readings=readings).file())).set_aside == ()


def test_exchanged_rows_are_no_gross_readings() -> None:
    truth = drawn(seed=4)
    order = np.arange(len(truth.readings))
    order[[3, 9]] = 9, 3
    session = read_session(replace(truth, readings=truth.readings[order]).file())
    assert calibrate(session).set_aside == ()


def test_the_diagnosis_names_it_and_accuses_no_other_sensor() -> None:
    truth = drawn(seed=3)
    diagnosis = diagnose(with_reading(truth, 17, 1, 0.0))
    assert [(f.cause, f.sensors) for f in diagnosis.findings] == [("reading-outlier", (truth.names[1],))]
    assert diagnosis.structures == ()
    assert "row 18" in diagnosis.findings[0].advice


def test_many_at_once_are_as_one_by_one_and_the_document_holds_them() -> None:
    truth = drawn(seed=3)
    sessions = [read_session(truth.file()), with_reading(truth, 5, 0, 0.0)]
    for one, together in zip(map(calibrate, sessions), calibrate_many(sessions), strict=True):
        assert places(one) == places(together)
        kept = Calibration.from_dict(json.loads(json.dumps(together.to_dict())))
        assert kept.set_aside == together.set_aside
    assert "set_aside" not in calibrate(sessions[0]).to_dict()


def test_sound_sessions_have_none() -> None:
    rng = np.random.default_rng(8)
    for draw, _ in pairwise([stand, orientations] * 8):
        assert calibrate(read_session(draw(rng).file())).set_aside == ()
