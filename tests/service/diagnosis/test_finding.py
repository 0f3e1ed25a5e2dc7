"""A finding in words: sizes and shapes by sensor, chance, and what would distinguish equal causes."""

from dataclasses import replace
from math import nan

import pytest

from estimator.diagnosis.explanation.findings import nonlinear
from estimator.diagnosis.results import Rival
from service.diagnosis.words.amplitudes import amplitudes_of, shape_of
from service.diagnosis.words.causes import cause_name, cause_on, what_is_wrong
from service.diagnosis.words.findings import evidence, finding_view
from service.kit.measures import THIN
from tests.service.findings import JUMP

NAMED = replace(JUMP, alternatives=())
LONE = replace(JUMP, alternatives=("unexplained",))


def test_two_shape_parameters_of_one_unit_are_told_apart() -> None:
    each = nonlinear(("s", "row", "s"), (60.0, 3.0, 900.0))
    assert each == {"s 1": 60.0, "row": 4.0, "s 2": 900.0}
    assert nonlinear(("row", "s"), (3.0, 60.0)) == {"row": 4.0, "s": 60.0}
    words = shape_of(replace(JUMP, cause="thermal-lag", nonlinear_each=(each,)))
    assert words == f"time constant 60{THIN}s and row 4 and 900{THIN}s"


def test_a_named_cause_is_said_in_its_sentence() -> None:
    assert what_is_wrong(NAMED) == "The zero of A1 and A2 jumped."


def test_equal_causes_are_listed() -> None:
    assert what_is_wrong(JUMP) == "Cannot tell which: bias jump or warm up (A1, A2)."


def test_a_cause_that_is_far_less_likely_is_no_equal() -> None:
    ranking = (Rival("bias-jump", ("A1", "A2"), 0.98, 8.0), Rival("warm-up", ("A1", "A2"), 0.01, 5.0))
    likely = replace(JUMP, ranking=ranking)
    assert (
        what_is_wrong(likely) == "The zero of A1 and A2 jumped (98.0\u00a0% likely); less likely warm up, 1.0\u00a0%."
    )
    assert (finding_view(likely).level, finding_view(JUMP).level) == (False, True)


def test_of_two_equal_causes_and_a_lesser_one_the_lesser_is_told_apart() -> None:
    ranking = (*JUMP.ranking, Rival("hysteresis", ("A1", "A2"), 0.02, 4.0))
    three = replace(JUMP, alternatives=("hysteresis", "warm-up"), ranking=ranking)
    said = "Cannot tell which: bias jump or warm up (A1, A2); less likely hysteresis, 2.0\u00a0%."
    assert what_is_wrong(three) == said


def test_of_many_equal_causes_three_are_listed_and_the_rest_is_counted() -> None:
    many = replace(JUMP, alternatives=("warm-up", "bias-ramp", "hysteresis", "saturation"), sensors=(), ranking=())
    assert what_is_wrong(many) == "Cannot tell which: bias jump, warm up, bias ramp or 2 more."


def test_a_cause_that_this_version_does_not_know_is_called_by_its_identifier() -> None:
    assert cause_name("bias-hum") == "bias hum"
    assert cause_on("bias-hum", ["A5"]) == "bias hum (A5)"
    assert finding_view(replace(NAMED, cause="bias-hum")).acceptable == ()


def test_that_no_known_cause_may_act_is_said() -> None:
    assert what_is_wrong(LONE) == "The zero of A1 and A2 jumped, or possibly a cause outside the catalogue."
    ranking = (Rival("bias-jump", ("A1", "A2"), 0.97, 9.0), Rival("unexplained", (), 0.03, 0.0))
    shared = "The zero of A1 and A2 jumped (97.0\u00a0% likely), or a cause outside the catalogue."
    assert what_is_wrong(replace(LONE, ranking=ranking)) == shared
    many = replace(JUMP, alternatives=("warm-up", "bias-ramp", "hysteresis", "unexplained"), sensors=(), ranking=())
    listed = "bias jump, warm up, bias ramp, 1 more or a cause outside the catalogue"
    assert what_is_wrong(many) == f"Cannot tell which: {listed}."


def test_a_sensor_with_two_names_has_two_causes_at_once_or_an_unknown_one() -> None:
    other = replace(LONE, cause="hysteresis")
    said = "Two causes at once, or a cause outside the catalogue (A1, A2): bias jump and hysteresis."
    assert what_is_wrong(LONE, (LONE, other)) == said
    assert what_is_wrong(LONE, (LONE, replace(other, sensors=("A3",)))) == what_is_wrong(LONE)


def test_no_model_can_take_in_a_cause_that_nobody_knows() -> None:
    assert [name for name, _ in finding_view(LONE).acceptable] == ["bias-jump"]


def test_a_cause_that_nobody_knows_has_no_share_among_the_known() -> None:
    known, unknown = finding_view(LONE).choices
    assert (known.share, unknown.name, unknown.share) == (
        "70.0\u00a0%", "a cause outside the catalogue (A1, A2)", "–"
    )  # fmt: skip


def test_chance_rests_on_the_stated_noise_unless_noise_itself_is_found() -> None:
    assert finding_view(NAMED, by_stated_noise=True).evidence.endswith("sound sessions, if the noise is as stated")
    noisy = replace(NAMED, cause="excess-noise")
    assert finding_view(noisy, by_stated_noise=True).evidence.endswith("sound sessions")


def test_every_sensor_s_own_shape_is_said() -> None:
    assert shape_of(JUMP) == "A1: from row 14; A2: from row 20"
    assert shape_of(replace(JUMP, nonlinear_each=({"row": 14.0},) * 2)) == "from row 14"


def test_every_sensor_s_own_size_is_said_with_its_expanded_uncertainty() -> None:
    assert list(amplitudes_of(JUMP)) == ["A1: 30.6\u00a0±\u00a02.0\u202fµg", "A2: 20.4\u00a0±\u00a02.0\u202fµg"]


def test_a_size_that_is_not_known_is_left_out() -> None:
    assert len(list(amplitudes_of(replace(JUMP, amplitude=(nan, 2e-4), sigma=(nan, 1e-5))))) == 1
    assert list(amplitudes_of(replace(JUMP, amplitude=(0.0, 0.0), sigma=(0.0, 0.0)))) == []


@pytest.mark.parametrize(
    ("p_value", "chance"),
    [
        (0.02, "by chance in 2.00\u00a0% of sound sessions"),
        (2.5e-5, "by chance in fewer than 1 of 10⁴ sound sessions"),
        (1e-30, "by chance in fewer than 1 of 10¹² sound sessions"),
        (nan, "no probability is known"),
    ],
)
def test_the_chance_of_a_sound_session_is_said(p_value: float, chance: str) -> None:
    assert evidence(8.0, p_value) == f"8.0 standard errors; {chance}"


def test_equal_causes_come_with_what_would_distinguish_them() -> None:
    first, second = finding_view(JUMP).choices
    assert (first.name, first.share, first.measurement) == ("bias jump (A1, A2)", "70.0\u00a0%", "")
    assert (second.now, second.measurement) == ("1.5\u00a0σ", "repeat the session (expected separation 4.5\u00a0σ)")


def test_a_measurement_that_would_not_help_is_not_proposed() -> None:
    near = replace(JUMP.separations[0], then=2.0)
    assert finding_view(replace(JUMP, separations=(near,))).choices[1].measurement.endswith("inspect the hardware")


def test_redundancy_says_stand_or_sensor() -> None:
    assert finding_view(JUMP).parity.startswith("χ² in parity space 900 → 40, along the axes 800 → 30.")
    assert finding_view(replace(JUMP, parity=None)).parity == ""


def test_an_angle_known_to_arcseconds_has_its_uncertainty_in_them() -> None:
    known = replace(JUMP, cause="mounting", sensors=(), amplitude=(0.7446330,), sigma=(2.8e-6,), units=("rad",))
    assert list(amplitudes_of(known)) == ["42.66433\u202f°\u00a0±\u00a01.2\u202farcsec"]
    assert list(amplitudes_of(replace(known, sigma=(5e-3,)))) == ["42.66\u00a0±\u00a00.57\u202f°"]
