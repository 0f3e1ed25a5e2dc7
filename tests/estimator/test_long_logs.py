"""Logs that are averaged part by part: the same positions as in one piece."""

from dataclasses import replace

import numpy as np
import pytest

from estimator.calibration.free import residual_per_freedom, tilt_response
from estimator.errors import FormatError, ScheduleError
from estimator.long_logs import LongLog, average_long
from estimator.long_logs.average import MOST_RESTS
from estimator.session import TWO_AXIS_STAND, CalibrationSession
from estimator.static import average
from tests.estimator.test_static import NOISE, RATE, raw, tumble

ROWS = ("readings", "standard_errors", "time", "temperature", "flipped", "beta", "directions", "position")
"""Fields as long as the log."""
COMPARED = (*ROWS, "at_ends", "vibration", "counts_averaged")


def cut(session: CalibrationSession, rows: int) -> list[CalibrationSession]:
    """The session in parts of so many rows."""
    given = {name: getattr(session, name) for name in ROWS if getattr(session, name) is not None}
    return [
        replace(session, **{name: values[at : at + rows] for name, values in given.items()})
        for at in range(0, len(session.readings), rows)
    ]


def in_parts(session: CalibrationSession, rows: int) -> LongLog:
    """The session as a log in parts."""

    def labels():
        for part in cut(session, rows):
            named = [part.position] if part.position is not None else [part.beta, part.flipped]
            yield np.column_stack(named)

    has_labels = session.position is not None or session.beta is not None
    return LongLog(lambda: iter(cut(session, rows)), labels if has_labels else None)


def labels_of(readings, places):
    """(R,) the number of the rest of every sample of a `tumble`, −1 between."""
    position = np.full(len(readings), -1)
    for k, (start, stop) in enumerate(places):
        position[start:stop] = k
    return position


def assert_same(session: CalibrationSession, rows: int) -> None:
    """Asserts that the session is averaged to the same in parts and in one piece."""
    whole = average(session, residual_per_freedom, tilt_response)
    parts = average_long(in_parts(session, rows), residual_per_freedom, tilt_response)
    for name in COMPARED:
        expected = getattr(whole, name)
        if expected is None:
            assert getattr(parts, name) is None
        else:
            np.testing.assert_allclose(getattr(parts, name), expected, rtol=1e-7, atol=1e-12, err_msg=name)


def drifting(seed=0):
    """A labelled log with times, temperatures and noise that hangs together, read in steps."""
    readings, places = tumble(poses=8, seed=seed)
    rng = np.random.default_rng(seed)
    readings = (readings + np.cumsum(rng.normal(0, NOISE / 30, readings.shape), axis=0)).round(3)
    t = np.arange(len(readings)) / RATE
    return raw(readings, position=labels_of(readings, places), time=t, temperature=20 + 0.01 * t)


@pytest.mark.parametrize("rows", [37, 1000, 10**6])
def test_a_labelled_log_in_parts_is_averaged_as_in_one_piece(rows):
    assert_same(drifting(), rows)


@pytest.mark.parametrize("rows", [700, 10**6])
def test_rests_are_found_in_parts_as_in_one_piece(rows):
    readings, _ = tumble(poses=8)
    assert_same(raw(readings), rows)


def test_the_settings_of_a_stand_are_positions_in_parts_too():
    readings, places = tumble(poses=6, turn=0.5)
    setting = np.repeat(np.arange(6.0), np.diff([*places[:, 0], len(readings)]))
    assert_same(raw(readings, programme=TWO_AXIS_STAND, beta=setting, flipped=setting > 2), 333)


def test_a_single_sample_a_position_has_no_standard_error_in_parts_either():
    readings = np.eye(3)[np.arange(60) % 3] * 9.81
    assert_same(raw(readings, position=np.arange(60)), 7)


def test_a_log_that_moves_while_it_should_rest_is_refused_in_parts_too():
    readings, places = tumble(poses=4, rest=2.0, turn=6.0)
    wrong = np.repeat(np.arange(4), np.diff([*places[:, 0], len(readings)]))
    with pytest.raises(ScheduleError, match="the block moves in"):
        average_long(in_parts(raw(readings, position=wrong), 500), residual_per_freedom, tilt_response)


def test_a_log_that_never_rests_is_refused_in_parts_too():
    rng = np.random.default_rng(0)
    log = raw(rng.normal(0, 5, (3000, 3)))
    with pytest.raises(ScheduleError, match=r"in 3000 samples the block is still for .* fewer than 4 times"):
        average_long(in_parts(log, 999), residual_per_freedom, tilt_response)


def test_a_log_that_rests_too_often_is_said_to(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("estimator.long_logs.average.MOST_RESTS", 5)
    readings, _ = tumble(poses=8, rest=4.0, turn=2.0)
    with pytest.raises(ScheduleError, match=r"is still 8 times; a log of 5 positions can be averaged, so split it"):
        average_long(in_parts(raw(readings), 999), residual_per_freedom, tilt_response)


def test_a_single_position_is_refused_in_parts_too():
    log = raw(np.full((500, 3), 1.0), position=np.zeros(500, int))
    with pytest.raises(ScheduleError, match="a single position"):
        average_long(in_parts(log, 100), residual_per_freedom, tilt_response)


def test_labels_that_change_all_the_time_are_refused():
    log = raw(np.ones((3 * MOST_RESTS, 3)), position=np.arange(3 * MOST_RESTS))
    with pytest.raises(ScheduleError, match="so split it"):
        average_long(in_parts(log, 1000), residual_per_freedom, tilt_response)


def test_a_column_that_ends_on_the_way_is_named():
    log = drifting()
    parts = cut(log, 1000)
    parts[2] = replace(parts[2], temperature=None)
    broken = LongLog(lambda: iter(parts), in_parts(log, 1000).labels)
    with pytest.raises(FormatError, match="temperature"):
        average_long(broken, residual_per_freedom, tilt_response)
