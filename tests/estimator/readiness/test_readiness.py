"""Ready, wait, not still, too early, or nothing to tell by."""

from dataclasses import replace

import numpy as np
import pytest

from estimator.readiness import Allowed, Question, ReadinessState
from estimator.readiness.faults import FaultKind
from estimator.readiness.results import DisturbanceKind
from estimator.session import ACCELEROMETER
from service.demo.blocks import MICRO_G, sensors_of
from tests.estimator.readiness.records import FORCE, G, clock, judged, record


def test_a_warm_and_still_unit_is_ready() -> None:
    found = judged(record(np.zeros((480, 4))))
    assert (found.state, found.disturbances, found.faults) == (ReadinessState.READY, (), ())
    assert all(one.bound < one.allowed == pytest.approx(12.5 * MICRO_G) for one in found.outlooks)


def test_a_cold_unit_is_told_how_long_to_wait() -> None:
    settling = 400 * (1 - np.exp(-clock(30) / 1200))
    found = judged(record(np.outer(settling, [0, 1, 0, 0])))
    still_to_wait = 1200 * np.log(400 * np.exp(-1800 / 1200) * (1 - np.exp(-5760 / 1200)) / 12.5)
    assert found.state is ReadinessState.NOT_WARM
    assert found.wait is not None
    assert found.wait[0] <= still_to_wait <= found.wait[2]


@pytest.mark.slow
def test_the_time_to_wait_is_given_with_nine_tenths_of_its_chance() -> None:
    """The true time lies inside nine times in ten over many records: within what half of it would hold, five."""
    settling = 400 * (1 - np.exp(-clock(30) / 1200))
    still_to_wait = 1200 * np.log(400 * np.exp(-1800 / 1200) * (1 - np.exp(-5760 / 1200)) / 12.5)
    waits = [judged(record(np.outer(settling, [0, 1, 0, 0]), white=3.0, seed=seed)).wait for seed in range(24)]
    inside = [wait is not None and wait[0] <= still_to_wait <= wait[2] for wait in waits]
    assert sum(inside) >= 19


def test_a_steady_drift_is_not_waited_for() -> None:
    found = judged(record(np.outer(clock(60), [0.1, 0, 0, 0])))
    assert (found.state, found.wait) == (ReadinessState.NOT_WARM, None)


def test_a_short_record_is_told_how_much_longer_it_must_be() -> None:
    found = judged(record(np.zeros((60, 4)), white=3.0))
    assert found.state is ReadinessState.TOO_EARLY
    assert found.needed is not None


def test_a_touch_is_named_with_its_time_and_what_follows_is_judged_alone() -> None:
    course = np.zeros((540, 4))
    course[60:, 1] = 40.0
    found = judged(record(course))
    (touch,) = found.disturbances
    assert (touch.kind, touch.sensors, touch.passed) == (DisturbanceKind.STEP, ("A2",), True)
    assert touch.start - 120 <= 600 <= touch.stop + 120
    assert (found.state, found.judged_from >= 600) == (ReadinessState.READY, True)


def test_a_unit_that_warms_up_quickly_was_not_touched() -> None:
    found = judged(record(np.outer(np.exp(-clock(80) / 1200), [0, 350, 0, 0])))
    assert found.disturbances == ()


def test_a_touch_at_the_end_is_not_still() -> None:
    course = np.zeros((300, 4))
    course[270:, 1] = 40.0
    assert judged(record(course)).state is ReadinessState.NOT_STILL


def test_drifts_that_are_one_turn_are_the_fixture_s() -> None:
    axes = np.stack([s.nominal_axis for s in sensors_of(ACCELEROMETER, 6)])
    turning = np.cross(axes, FORCE) @ np.array([1.0, 0.0, 0.5]) / G
    found = judged(record(np.outer(0.05 * clock(60), turning)))
    assert found.state is ReadinessState.NOT_STILL
    assert found.disturbances[-1].kind is DisturbanceKind.CREEP
    assert found.disturbances[-1].size == pytest.approx(0.05 * 5760 * np.hypot(1, 0.5) * 1e-6, rel=0.1)


def test_a_burst_in_a_raw_log_is_named_with_its_time() -> None:
    rng = np.random.default_rng(8)
    course = 20 * rng.standard_normal((60_000, 3))
    course[9_000:9_400] *= 8
    found = judged(replace(record(course, white=0.0), time=None, sample_rate=100.0))
    burst = found.disturbances[0]
    assert (burst.kind, burst.start <= 90.0, burst.stop >= 94.0) == (DisturbanceKind.BURST, True, True)


def test_the_scale_factor_s_tolerance_counts_where_it_is_the_nearer_one() -> None:
    question = Question({ACCELEROMETER: Allowed(50 * MICRO_G, 10e-6)}, 5760.0)
    found = judged(record(np.zeros((480, 4))), question)
    assert {one.limit for one in found.outlooks} == {"scale"}


def test_the_thermometer_speaks_for_the_zeros_where_its_coefficient_is_known() -> None:
    cooling = replace(record(np.zeros((360, 4))), temperature=20 + clock(60) / 600)
    question = Question({ACCELEROMETER: Allowed(50 * MICRO_G)}, 5760.0, coefficient={ACCELEROMETER: 20 * MICRO_G})
    found = judged(cooling, question)
    assert found.state is ReadinessState.NOT_WARM
    assert found.temperature is not None
    assert found.temperature.expected == pytest.approx(5760 / 600 * 20 * MICRO_G, rel=0.05)


still = record(np.zeros((120, 4)))
FAULTY = {
    FaultKind.NO_TIME: replace(still, time=None),
    FaultKind.CLOCK_BACK: replace(still, time=np.r_[clock(10), clock(10)]),
    FaultKind.CLOCK_STANDS: replace(still, time=np.zeros(120)),
    FaultKind.FEW: record(np.zeros((5, 4))),
    FaultKind.STUCK: replace(still, readings=np.tile(still.readings[:1], (120, 1))),
    FaultKind.COARSE: replace(still, readings=np.round(still.readings, 2) + 0.01 * (np.arange(120) % 2)[:, None]),
    FaultKind.UNITS: replace(still, readings=still.readings * G),
    FaultKind.POSITIONS: replace(still, position=np.arange(120)),
    FaultKind.NOT_FINITE: replace(still, readings=np.where(np.arange(120)[:, None] == 7, np.nan, still.readings)),
}


@pytest.mark.parametrize("kind", FAULTY)
def test_a_record_that_says_nothing_is_noticed(kind: FaultKind) -> None:
    found = judged(FAULTY[kind])
    assert found.state is ReadinessState.CANNOT_TELL
    assert kind in {fault.kind for fault in found.faults}


def test_a_gap_is_said_and_judged_all_the_same() -> None:
    gone = replace(record(np.zeros((480, 4))), time=np.where(np.arange(480) < 200, clock(80), clock(80) + 1800.0))
    found = judged(gone)
    assert (found.state, [fault.kind for fault in found.faults]) == (ReadinessState.READY, [FaultKind.GAP])


def test_one_sensor_is_judged_and_said_to_be_alone() -> None:
    one = record(np.zeros((480, 3)))
    found = judged(replace(one, sensors=one.sensors[:1], readings=one.readings[:, :1]))
    assert (found.state, [fault.kind for fault in found.faults]) == (ReadinessState.READY, [FaultKind.ALONE])
