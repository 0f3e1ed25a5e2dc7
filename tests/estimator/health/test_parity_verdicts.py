"""Verdicts on each parameter from a recording in service: four states for candidates, detectable or not for others."""

from dataclasses import replace
from functools import cache

import pytest

from estimator.health import ParameterJudgement
from estimator.health.parity import judge_parity
from estimator.parity import CourseFault, ParityResult, parity_check
from estimator.session import ACCELEROMETER
from tests.estimator.parity.cases import biased, block, recording

MOVED = 5e-3
"""m/s²"""


@cache
def judged(sensors: int, moved: float, tolerance: float) -> dict[str, ParameterJudgement]:
    """The biases by sensor; the second one's zero has moved, m/s²."""
    true, reference = block(sensors)
    found = parity_check(recording(biased(true, 1, moved), seconds=120.0), reference)
    return {j.sensor: j for j in judge_parity(found, reference, {(ACCELEROMETER, "bias"): tolerance})}


def verdicts(sensors: int, moved: float, tolerance: float) -> dict[str, str]:
    return {name: j.verdict for name, j in judged(sensors, moved, tolerance).items()}


def test_an_unchanged_block_passes_where_the_tolerance_would_have_been_detected() -> None:
    assert set(verdicts(6, 0.0, 1e-2).values()) == {"pass"}


def test_an_unchanged_block_is_undecidable_where_the_tolerance_could_have_hidden() -> None:
    assert set(verdicts(6, 0.0, 1e-5).values()) == {"undecidable"}


def test_the_tolerance_is_seen_from_the_detectable_size_on() -> None:
    size = judged(6, 0.0, 1.0)["A1"].critical
    assert size is not None
    assert (verdicts(6, 0.0, size)["A1"], verdicts(6, 0.0, 0.999 * size)["A1"]) == ("pass", "undecidable")


def test_a_sensor_that_moved_beyond_its_tolerance_fails_alone() -> None:
    found = verdicts(6, MOVED, 2e-3)
    assert {name for name, verdict in found.items() if verdict == "fail"} == {"A2"}
    assert {verdict for name, verdict in found.items() if name != "A2"} == {"pass"}


def test_the_others_pass_only_where_the_tolerance_would_have_been_detected() -> None:
    """The others' own changes would be within it by the four states."""
    size = judged(6, MOVED, 1.0)["A1"].critical
    assert size is not None
    assert set(verdicts(6, MOVED, 0.6 * size).values()) == {"fail", "undecidable"}


def test_a_sensor_that_moved_within_its_tolerance_passes() -> None:
    assert verdicts(6, MOVED, 2e-2)["A2"] == "pass"


def test_nobody_passes_where_a_change_cannot_be_attributed() -> None:
    assert "pass" not in verdicts(4, MOVED, 1.0).values()


def test_a_candidate_beyond_its_tolerance_fails_even_where_several_could_be_it() -> None:
    assert "fail" in verdicts(4, MOVED, 1e-3).values()


def test_the_measured_value_is_the_reference_moved_by_the_change() -> None:
    found = judged(6, MOVED, 2e-3)["A2"]
    assert found.value == pytest.approx((found.reference or 0) + (found.deviation or 0))
    assert found.deviation == pytest.approx(MOVED, abs=4 * (found.uncertainty or 0))
    assert found.expanded == 2 * (found.uncertainty or 0)


def test_a_scale_moves_relative_to_its_reference_and_an_axis_from_zero() -> None:
    true, reference = block(6)
    found = parity_check(recording(true, seconds=120.0), reference)
    scale, axis = judge_parity(found, reference, {(ACCELEROMETER, p): 1e-3 for p in ("scale", "axis")})[:2]
    assert scale.value == pytest.approx((scale.reference or 0) * (1 + (scale.deviation or 0)))
    assert (axis.reference, axis.value) == (0.0, axis.deviation)


STUCK = CourseFault("A2", ("A2",), "stuck", 60.0, None, 0.1, None, None, 1e-9)


def with_faults(*faults: CourseFault, before: ParityResult | None) -> dict[str, ParameterJudgement]:
    """The biases of a sound block of six in which some fail, by sensor."""
    found = replace(parity_check(recording(block(6)[0], seconds=120.0), block(6)[1]), faults=faults, before=before)
    return {j.sensor: j for j in judge_parity(found, block(6)[1], {(ACCELEROMETER, "bias"): 1e-2})}


def sound() -> ParityResult:
    """The part before."""
    return parity_check(recording(block(6)[0], seconds=60.0), block(6)[1])


def test_a_sensor_that_fails_within_the_recording_fails_and_the_others_are_judged_by_the_part_before() -> None:
    found = with_faults(STUCK, before=sound())
    assert (found["A2"].verdict, found["A2"].deviation, found["A2"].expanded) == ("fail", None, None)
    assert {found[name].verdict for name in found if name != "A2"} == {"pass"}
    assert found["A1"].deviation == sound().sensor("A1").bias.size


def test_all_that_could_be_the_failing_one_fail() -> None:
    found = with_faults(replace(STUCK, sensor=None, suspects=("A2", "A5")), before=sound())
    assert {name for name in found if found[name].verdict == "fail"} == {"A2", "A5"}


def test_without_a_part_before_nothing_is_known_of_the_others() -> None:
    found = with_faults(STUCK, before=None)
    assert (found["A2"].verdict, found["A1"].verdict, found["A1"].value) == ("fail", "undecidable", None)
