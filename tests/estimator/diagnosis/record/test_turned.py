"""Record errors told from axes that are far from where they should be, and put right."""

import numpy as np
import pytest

from estimator.causes import CATALOGUE, RecordCorrection
from estimator.diagnosis.record.turned import expected_axes, turned_record
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.session import ACCELEROMETER
from tests.estimator.causes.hiding import scene, with_readings

WHERE = scene(ACCELEROMETER, 2)
TURNED = [c for c in CATALOGUE if isinstance(c, RecordCorrection) and c.between]


@pytest.mark.parametrize("error", TURNED, ids=lambda c: c.identifier)
def test_a_turned_record_is_found_and_put_right(error: RecordCorrection) -> None:
    session = WHERE.measured(1)
    place, wrong = list(error.corrected(session))[-1]
    found = turned_record(baseline_of(wrong), expected_axes([], wrong), TURNED)
    assert found is not None
    assert (found.undone.cause.identifier, found.undone.places) == (error.identifier, place)
    assert np.array_equal(found.undone.session.readings, session.readings)


def test_a_sound_record_is_left_alone() -> None:
    session = WHERE.measured(1)
    assert turned_record(baseline_of(session), expected_axes([], session), TURNED) is None


@pytest.mark.parametrize("step", [-9.0, -22.0], ids=lambda step: f"{step} m/s²")
def test_a_sensor_that_steps_as_its_input_changes_sign_is_not_turned_over(step: float) -> None:
    session = WHERE.measured(1)
    jumps = 0.12 * step * np.sign(session.readings[:, 2])
    stepping = with_readings(session, jumps[:, None] * np.eye(6)[2])
    assert turned_record(baseline_of(stepping), expected_axes([], stepping), TURNED) is None


def test_the_axes_to_expect_are_those_of_the_history() -> None:
    session, *history = WHERE.measured(1), *map(baseline_of, WHERE.earlier(1))
    assert np.array_equal(expected_axes(history, session), history[-1].parameters.axis)


def test_without_history_the_axes_to_expect_are_the_nominal_ones() -> None:
    session = WHERE.measured(1)
    assert np.array_equal(expected_axes([], session), [s.nominal_axis for s in session.sensors])
