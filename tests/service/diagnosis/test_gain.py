"""Gain from naming causes, for every kind of sensor in its own unit."""

from dataclasses import replace

import pytest

from estimator import calibrate
from estimator.diagnosis.results import Gain, Score
from estimator.reading import read_session
from estimator.results import Calibration
from estimator.session import ACCELEROMETER, GYROSCOPE
from service.diagnosis.gain import gain_view
from service.diagnosis.words.gain import gain_in_words
from service.kit.measures import MEASURES
from service.sessions.decision import Verdict
from tests.builders import accelerometer_block

MICRO_G, DEGREE_AN_HOUR = (1 / MEASURES[kind, "bias"].factor for kind in (ACCELEROMETER, GYROSCOPE))
BEFORE = Score(9 * MICRO_G, 3.0, -1.0, {ACCELEROMETER: 9 * MICRO_G, GYROSCOPE: 2 * DEGREE_AN_HOUR})
AFTER = Score(5 * MICRO_G, 1.0, -0.5, {ACCELEROMETER: 5 * MICRO_G, GYROSCOPE: 2 * DEGREE_AN_HOUR})


def block(*, mixed: bool) -> Calibration:
    """Calibration of accelerometers; ``mixed``: the last of which is taken for a gyro."""
    found = calibrate(read_session(accelerometer_block()))
    last = replace(found.sensors[-1], kind=GYROSCOPE)
    return replace(found, sensors=(*found.sensors[:-1], last)) if mixed else found


def rms(before: Score, after: Score, *, mixed: bool) -> list[tuple[str, str, str]]:
    """Values in each line of rms."""
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


def told(before: dict[str, float], after: dict[str, float], *sensors: str) -> str:
    """The sentence about accelerometers of so many µg before and after."""
    each = ({ACCELEROMETER: {name: error * MICRO_G for name, error in own.items()}} for own in (before, after))
    first, second = (replace(BEFORE, rms_by_sensor=own) for own in each)
    return gain_in_words(Gain(first, second, "positions"), sensors).replace("\u202f", " ")


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        (14.0, 7.0, "halves: 14 → 7 µg"),
        (9.0, 6.0, "falls by a third: 9.0 → 6.0 µg"),
        (9.0, 3.0, "falls to a third: 9.0 → 3.0 µg"),
        (14.0, 0.4, "falls from 14.0 to 0.4 µg"),
        (14.0, 12.0, "falls from 14 to 12 µg"),
        (14.0, 14.1, "does not fall: 14 → 14 µg"),
        (14.0, 20.0, "rises from 14 to 20 µg"),
        (26000.0, 13000.0, "halves: 26 → 13 mg"),
    ],
)
def test_a_person_reads_one_number(before: float, after: float, words: str) -> None:
    whole = f"Held-out error of A2 {words} (readings that took no part)."
    assert told({"A1": 3.0, "A2": before}, {"A1": 3.0, "A2": after}, "A2") == whole


def test_the_worst_three_are_named_and_the_others_counted() -> None:
    before = {f"A{k}": 10.0 + k for k in range(1, 8)}
    after = {name: error / 2 for name, error in before.items()}
    sentence = told(before, after)
    assert [name for name in before if f"{name} halves" in sentence] == ["A5", "A6", "A7"]
    assert sentence.index("A7") < sentence.index("A6") < sentence.index("A5")
    assert "; and 4 more (" in sentence


def test_each_sensor_has_its_own_unit() -> None:
    before, after = (
        replace(score, rms_by_sensor={ACCELEROMETER: {"A1": k * 2 * MICRO_G}, GYROSCOPE: {"G1": k * DEGREE_AN_HOUR}})
        for k, score in ((2, BEFORE), (1, AFTER))
    )
    sentence = gain_in_words(Gain(before, after, "positions")).replace("\u202f", " ")
    assert "of A1 halves: 4.0 → 2.0 µg" in sentence
    assert "of G1 halves: 2.0 → 1.0 °/h" in sentence


def test_an_earlier_version_stated_no_sensor() -> None:
    assert gain_in_words(Gain(BEFORE, AFTER, "positions")) == ""


def test_a_change_since_earlier_sessions_leaves_every_prediction_as_it_was() -> None:
    assert told({"A2": 8.0}, {"A2": 8.0}) == ""
