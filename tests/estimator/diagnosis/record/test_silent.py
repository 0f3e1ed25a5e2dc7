"""A channel that reads the same in every row is dead only where its input changes."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from estimator import ScheduleError, diagnose, read_session
from estimator.calibration import calibrate
from estimator.diagnosis.record.silent import silent_channels
from estimator.session import CalibrationSession
from tests.builders import accelerometer_block, gyro_block

BLOCKS = pytest.mark.parametrize("block", [accelerometer_block, gyro_block])


def dead_channels(session: CalibrationSession) -> tuple[str, ...]:
    """Channels set aside in every row."""
    return tuple(a.sensor for a in calibrate(session).set_aside if a.last_row - a.row + 1 == len(session.readings))


def constant(session: CalibrationSession, value: float) -> CalibrationSession:
    """The first channel reads the same."""
    readings = session.readings.copy()
    readings[:, 0] = value
    return replace(session, readings=readings)


@BLOCKS
@pytest.mark.parametrize("value", [0.0, -1.5, 1e18])
def test_a_channel_that_does_not_answer_is_dead_whatever_it_reads(
    block: Callable[..., dict[str, Any]], value: float
) -> None:
    session = constant(read_session(block(3, positions=4)), value)
    assert dead_channels(session) == (session.sensors[0].name,)
    with pytest.raises(ScheduleError, match="has the same reading in every row"):
        diagnose(session)


@BLOCKS
def test_no_channel_of_a_sound_block_is_silent(block: Callable[..., dict[str, Any]]) -> None:
    assert silent_channels(read_session(block(3, positions=4))) == ()


def test_a_sensor_along_the_axis_of_turning_reads_the_same_in_one_run() -> None:
    session = constant(read_session(accelerometer_block(3, positions=4, runs=("direct",))), 0.7)
    along = replace(session.sensors[0], nominal_axis=np.array([0.0, 1.0, 0.0]))
    session = replace(session, sensors=(along, *session.sensors[1:]))
    assert (silent_channels(session), dead_channels(session)) == (("A1",), ())


def test_counts_too_coarse_for_the_input_round_to_the_same() -> None:
    short = read_session(gyro_block(3, positions=4, count_time_s=0.01))
    assert dead_channels(constant(short, 0.0)) == ()
    assert dead_channels(constant(short, 0.5)) == ("G1",)


def test_an_earlier_session_with_a_dead_channel_is_passed_over() -> None:
    session = read_session(accelerometer_block(4, positions=12))
    assert diagnose(session, (constant(session, 0.0),)).findings == diagnose(session).findings
