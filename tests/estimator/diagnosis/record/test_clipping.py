"""Channels at the end of their range are told by equal readings, named with their limit, and take no part."""

from dataclasses import replace

import numpy as np
import pytest

from estimator import CalibrationSession, Diagnosis, diagnose
from estimator.causes import CATALOGUE
from estimator.diagnosis.explanation.accepted import calibrate_extended
from estimator.diagnosis.record.clipping import unclipped
from estimator.session import ACCELEROMETER, GYROSCOPE
from tests.estimator.causes.hiding import Scene, scene

WHERE, GYROS = scene(ACCELEROMETER, 0), scene(GYROSCOPE, 0)
SENSOR = 2


def clipped(session: CalibrationSession, low: float, high: float) -> CalibrationSession:
    """The session with one sensor clipped beyond these shares of its readings' range."""
    readings = session.readings.copy()
    ends = np.quantile(readings[:, SENSOR], [low, high])
    readings[:, SENSOR] = np.clip(readings[:, SENSOR], *ends)
    return replace(session, readings=readings)


def blind(session: CalibrationSession) -> CalibrationSession:
    """The session with no noise stated."""
    return replace(session, standard_errors=np.full(session.readings.shape, np.nan))


def named(found: Diagnosis) -> list[tuple[str, tuple[str, ...]]]:
    return [(f.cause, tuple(dict.fromkeys(f.sensors))) for f in found.findings]


def pulls(found: Diagnosis, where: Scene) -> np.ndarray:
    """Errors of the clipped sensor's scale and bias in their sigmas."""
    own, true = found.calibration.sensors[SENSOR], where.world.truth
    return np.array(
        [
            (own.scale.value - true.scale[SENSOR]) / own.scale.sigma,
            (own.bias.value - true.bias[SENSOR]) / own.bias.sigma,
        ]
    )


@pytest.mark.parametrize("where", [WHERE, GYROS], ids=["accelerometers", "gyros"])
@pytest.mark.parametrize("share", [0.08, 0.2, 0.4])
def test_a_clipped_sensor_is_named_with_its_limit_and_calibrated_by_its_other_rows(where: Scene, share: float) -> None:
    session = clipped(where.measured(1), 0.0, 1 - share)
    found = diagnose(session)
    sensor = session.sensors[SENSOR].name
    assert named(found) == [("saturation", (sensor,))]
    limit = session.readings[:, SENSOR].max() / where.world.truth.scale[SENSOR]
    assert found.findings[0].amplitude[0] == pytest.approx(abs(limit), rel=1e-3)
    assert found.findings[0].nonlinear["side"] == 1.0
    assert np.all(np.abs(pulls(found, where)) < 4)


def test_both_sides_are_one_finding() -> None:
    found = diagnose(clipped(WHERE.measured(1), 0.1, 0.9))
    assert named(found) == [("saturation", ("A3",))]
    assert sorted(each["side"] for each in found.findings[0].nonlinear_each) == [-1.0, 1.0]
    assert "A3 is clipped" in found.findings[0].sentence


def test_without_a_stated_noise_it_is_named_too() -> None:
    assert named(diagnose(blind(clipped(WHERE.measured(1), 0.0, 0.8)))) == [("saturation", ("A3",))]


def test_a_history_clipped_as_well_makes_no_drift() -> None:
    history = [clipped(WHERE.measured(seed), 0.0, 0.9) for seed in (2, 3)]
    assert named(diagnose(clipped(WHERE.measured(1), 0.0, 0.8), history)) == [("saturation", ("A3",))]


def test_equal_readings_that_are_expected_are_no_clipping() -> None:
    session = WHERE.measured(1)
    readings = session.readings.copy()
    top = np.argsort(readings[:, SENSOR])[-2:]
    readings[top, SENSOR] = readings[top, SENSOR].max() - 1e-7
    clips, same = unclipped(replace(session, readings=np.round(readings, 5)), CATALOGUE)
    assert clips == []
    assert np.array_equal(same.readings, np.round(readings, 5))


def test_rounded_counts_repeat_and_are_no_clipping() -> None:
    for seed in range(10):
        session = GYROS.measured(seed)
        step = 3 * float(np.median(session.standard_errors))
        assert unclipped(replace(session, readings=np.round(session.readings / step) * step), CATALOGUE)[0] == []


def test_what_the_other_rows_leave_open_is_not_put_right() -> None:
    session = clipped(WHERE.measured(1), 0.0, 0.06)
    assert unclipped(session, CATALOGUE)[0] == []


def test_without_the_cause_nothing_is_put_right() -> None:
    session = clipped(WHERE.measured(1), 0.0, 0.8)
    assert unclipped(session, [c for c in CATALOGUE if c.identifier != "saturation"]) == ([], session)


def test_an_accepted_saturation_calibrates_by_the_other_rows() -> None:
    session = clipped(WHERE.measured(1), 0.0, 0.8)
    extended = calibrate_extended(session, [("saturation", ("A3",))])
    own, true = extended.sensors[SENSOR], WHERE.world.truth.scale[SENSOR]
    assert abs(own.scale.value - true) < 4 * own.scale.sigma


def test_the_gain_is_held_against_the_record_as_it_came() -> None:
    found = diagnose(clipped(WHERE.measured(1), 0.0, 0.8))
    assert found.gain.before.chi2_per_dof > 100 > 2 > found.gain.after.chi2_per_dof
    assert found.gain.before.rms > 10 * found.gain.after.rms
    assert found.gain.before.log_score < found.gain.after.log_score
