"""Detection limits of a session in people's measures, and the causes it cannot see."""

from estimator.causes import CATALOGUE
from estimator.diagnosis.results import Limit
from estimator.session import ACCELEROMETER, GYROSCOPE
from service.diagnosis.words.amplitudes import AMPLITUDE_MEASURES, amplitude_measure
from service.diagnosis.words.diagnosis import BlindCauses, SeenCause, blind_causes, seen_causes

RAMP = Limit("bias-ramp", (1e-8,), ("m/s²/s",), "")


def test_a_limit_is_read_in_the_measures_of_the_block() -> None:
    assert seen_causes([RAMP], {ACCELEROMETER}) == (SeenCause("bias ramp", "3.7\u202fµg/h"),)
    assert seen_causes([RAMP], {ACCELEROMETER, GYROSCOPE}) == seen_causes([RAMP], {ACCELEROMETER})
    assert seen_causes([RAMP], {GYROSCOPE}) == (SeenCause("bias ramp", "7.4\u202f(°/h)/h"),)


def test_the_m_s2_of_a_gyro_s_own_cause_is_acceleration() -> None:
    own = Limit("g-sensitivity", (1e-6,), ("(rad/s)/(m/s²)",), "")
    assert seen_causes([own], {GYROSCOPE})[0].size.endswith("(°/h)/g")


def test_amplitudes_that_agree_are_one_number() -> None:
    two = Limit("axis-wobble", (1e-5, 1.001e-5), ("rad", "rad"), "")
    assert seen_causes([two], {ACCELEROMETER})[0].size == "2.1\u202farcsec"


def test_what_is_not_seen_stands_under_its_reason() -> None:
    blind = [Limit(name, None, (), "the session lacks time") for name in ("bias-ramp", "warm-up")]
    assert blind_causes([RAMP, *blind]) == (BlindCauses("bias ramp, warm up", "the session lacks time"),)


def test_vibration_that_tells_nothing_is_not_called_missing_where_it_was_recorded() -> None:
    (blind,) = blind_causes([Limit("vibration-rectification", None, (), "the session lacks vibration")])
    assert blind.reason == "no vibration was recorded, or it was the same in every row"


def test_every_unit_of_the_catalogue_has_a_measure() -> None:
    stated = {unit for cause in CATALOGUE for unit in cause.units}
    both = stated | {unit.replace("m/s²", "rad/s") for cause in CATALOGUE if not cause.kind for unit in cause.units}
    assert both <= set(AMPLITUDE_MEASURES)


def test_an_angle_that_grows_is_no_rate() -> None:
    assert amplitude_measure("axis-creep", "rad/s", 0.0).label == "arcsec/h"
    assert amplitude_measure("bias-jump", "rad/s", 0.0).label == "°/h"
