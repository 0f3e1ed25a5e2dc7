"""Messages about schedules that cannot be calibrated, or only in part, name the place and the rows to add."""

from dataclasses import replace

import numpy as np
import pytest

from estimator.calibration import calibrate
from estimator.calibration.free.completion import MOST_CANDIDATES, candidate_directions
from estimator.errors import ScheduleError
from tests.estimator.calibration.free_sessions import session, sphere, spread_axes, truth
from tests.estimator.test_static import RATE, raw

TURN = np.linspace(0, 2 * np.pi, 12, endpoint=False)
IN_ONE_PLANE = np.column_stack([np.sin(TURN), 0 * TURN, np.cos(TURN)])


def refused(measured):
    with pytest.raises(ScheduleError) as caught:
        calibrate(measured)
    return caught.value.problems


@pytest.mark.parametrize("m", [3, 4, 6])
@pytest.mark.parametrize("directions", [IN_ONE_PLANE, sphere(7, np.random.default_rng(1))], ids=["one plane", "seven"])
def test_the_orientations_that_a_set_lacks_are_named_and_complete_it(m, directions):
    true = truth(m)
    found = calibrate(session(true, directions), quadratic=False)
    assert found.fit.rank < found.fit.parameters
    whole = calibrate(session(true, np.vstack([directions, found.fit.add])), quadratic=False)
    assert whole.fit.rank == whole.fit.parameters
    assert whole.fit.add == ()


def test_no_fewer_orientations_would_do():
    directions = sphere(7, np.random.default_rng(1))
    found = calibrate(session(truth(4), directions), quadratic=False)
    fewer = np.vstack([directions, found.fit.add[:-1]])
    assert calibrate(session(truth(4), fewer), quadratic=False).fit.rank < found.fit.parameters


def test_of_a_large_block_a_few_axes_that_span_space_are_asked():
    turn = np.linspace(0, np.pi, 60)
    axes = np.vstack([np.column_stack([np.cos(turn), np.sin(turn), 0 * turn]), [0.0, 0.0, 1.0]])
    chosen = candidate_directions(axes)
    assert chosen.shape == (MOST_CANDIDATES, 3)
    assert np.linalg.matrix_rank(chosen) == 3


def clipped(limit, sensor=1):
    """Thirty orientations of six sensors, one of which ends at ± a limit, in its reading's unit."""
    measured = session(truth(6), sphere(30, np.random.default_rng(2)))
    readings = measured.readings.copy()
    readings[:, sensor] = np.clip(readings[:, sensor], -limit * measured.sensors[sensor].nominal_scale, None)
    return replace(measured, readings=readings)


def test_a_channel_at_the_end_of_its_range_is_named_with_its_rows():
    (problem,) = refused(clipped(3.0))
    assert problem.field == "A2"
    assert "at the end of its range" in problem.message


def test_a_few_clipped_rows_are_left_to_the_diagnosis():
    assert calibrate(clipped(9.3)).fit.parameters > 0


def test_a_sensor_along_the_turn_axis_reads_the_same_and_is_not_cut_off():
    directions = np.vstack(
        [np.column_stack([0.8 * np.cos(TURN), 0.8 * np.sin(TURN), 0.6 + 0 * TURN]), sphere(9, np.random.default_rng(3))]
    )
    axes = np.vstack([spread_axes(5), [0.0, 0.0, 1.0]])
    true = replace(truth(6), axes=axes)
    measured = session(true, directions, noise=0.0, stated=False)
    assert calibrate(measured).fit.parameters > 0


def turning(seconds=120.0, period=40.0):
    """A triad that turns slowly and never rests."""
    t = np.arange(int(seconds * RATE)) / RATE
    force = 9.81 * np.column_stack(
        [np.sin(2 * np.pi * t / period), 0.3 * np.cos(t / 7), np.cos(2 * np.pi * t / period)]
    )
    return raw(force + 0.002 * np.random.default_rng(4).standard_normal(force.shape))


def test_a_slow_turn_is_not_taken_for_rest():
    (problem,) = refused(turning())
    assert "the block is still" in problem.message


def test_a_moving_record_given_as_still_is_refused_with_its_rows():
    measured = turning()
    labels = np.arange(len(measured.readings)) // int(10 * RATE)
    (problem,) = refused(replace(measured, position=labels))
    assert "the block moves in 12 of 12 positions (samples" in problem.message
