"""What naming causes is worth, of every kind of sensor in its own unit."""

from dataclasses import replace

from estimator import calibrate
from estimator.diagnosis.results import Gain, Score
from estimator.reading import read_session
from estimator.results import Calibration
from estimator.session import ACCELEROMETER, GYROSCOPE
from service.diagnosis.gain import gain_view
from service.kit.measures import MEASURES
from service.sessions.decision import Verdict
from tests.builders import accelerometer_block

MICRO_G, DEGREE_AN_HOUR = (1 / MEASURES[kind, "bias"].factor for kind in (ACCELEROMETER, GYROSCOPE))
BEFORE = Score(9 * MICRO_G, 3.0, -1.0, {ACCELEROMETER: 9 * MICRO_G, GYROSCOPE: 2 * DEGREE_AN_HOUR})
AFTER = Score(5 * MICRO_G, 1.0, -0.5, {ACCELEROMETER: 5 * MICRO_G, GYROSCOPE: 2 * DEGREE_AN_HOUR})


def block(*, mixed: bool) -> Calibration:
    """Of accelerometers; ``mixed``: of which the last is taken for a gyro."""
    found = calibrate(read_session(accelerometer_block()))
    last = replace(found.sensors[-1], kind=GYROSCOPE)
    return replace(found, sensors=(*found.sensors[:-1], last)) if mixed else found


def rms(before: Score, after: Score, *, mixed: bool) -> list[tuple[str, str, str]]:
    """What each line of rms says."""
    calibration = block(mixed=mixed)
    view = gain_view(Gain(before, after, "positions", None), calibration, calibration, Verdict.PASS, None)
    return [(row.meaning, row.before, row.after) for row in view.rows if row.name == "rms"]


def test_every_kind_of_sensor_has_a_line_in_its_own_unit() -> None:
    assert rms(BEFORE, AFTER, mixed=True) == [
        ("error of prediction of accelerometers, µg", "9.000", "5.000"),
        ("error of prediction of gyroscopes, °/h", "2.000", "2.000"),
    ]


def test_a_kind_that_the_block_does_not_hold_has_none() -> None:
    assert rms(BEFORE, AFTER, mixed=False) == [("error of prediction, µg", "9.000", "5.000")]


def test_an_earlier_version_stated_the_leading_kind_alone() -> None:
    earlier = [replace(score, rms_by_kind={}) for score in (BEFORE, AFTER)]
    assert rms(*earlier, mixed=True) == rms(*earlier, mixed=False) == [("error of prediction, µg", "9.000", "5.000")]


def test_a_gain_of_one_kind_alone_is_a_gain() -> None:
    calibration = block(mixed=True)
    other = replace(BEFORE, rms_by_kind=BEFORE.rms_by_kind | {GYROSCOPE: DEGREE_AN_HOUR})
    views = [
        gain_view(Gain(BEFORE, after, "positions", None), calibration, calibration, Verdict.PASS, None)
        for after in (BEFORE, other)
    ]
    assert [view.is_none for view in views] == [True, False]
