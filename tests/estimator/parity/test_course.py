"""A sensor that begins to fail within a recording: which, how, since when; and what is no fault."""

import json
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from estimator.parity import ParityResult, parity_check
from estimator.session import Array, CalibrationSession
from tests.estimator.parity.cases import block, recording

ONSET, RATE = 1400, 20.0
"""Row of the onset, of 2400; 20 Hz."""
SINCE = ONSET / RATE
LATE = 0.25
"""s"""


@cache
def flight(m: int = 6) -> CalibrationSession:
    return recording(block(m)[0], seconds=120.0)


def failed(change: Array | float, m: int = 6, sensor: int = 2, first: int = ONSET) -> ParityResult:
    """Result on a flight in which the last readings of a sensor are changed."""
    readings = flight(m).readings.copy()
    readings[first:, sensor] = change
    return parity_check(replace(flight(m), readings=readings), block(m)[1])


def later(m: int = 6, sensor: int = 2) -> Array:
    """Readings of the sensor from the onset on."""
    return flight(m).readings[ONSET:, sensor]


def test_nothing_begins_in_a_sound_flight() -> None:
    found = parity_check(flight(), block(6)[1])
    assert (found.faults, found.before, found.after) == ((), None, None)
    assert found.course_fine is not None
    assert found.course_fine.shape == (120, 6)


def drifting() -> Array:
    return later() + 0.02 * np.arange(len(later())) / RATE


def shaking() -> Array:
    return later() + 0.05 * np.random.default_rng(1).standard_normal(len(later()))


def beyond_its_range() -> Array:
    return np.clip(later() + 12.0 * np.random.default_rng(1).standard_normal(len(later())), -20.0, 20.0)


def late() -> Array:
    rows = np.arange(len(flight().readings))
    return np.interp(rows - LATE * RATE, rows, flight().readings[:, 2])[ONSET:]


def loose() -> Array:
    return later() + 0.3 * (np.arange(len(later())) // 100 % 2 == 0)


@pytest.mark.parametrize(
    ("kind", "change"),
    [
        ("step", lambda: later() + 0.05),
        ("ramp", drifting),
        ("stuck", lambda: later()[0]),
        ("zero", lambda: 0.0),
        ("full-scale", lambda: 1e3),
        ("gain", lambda: 1.05 * later()),
        ("noise", shaking),
        ("noise", beyond_its_range),
        ("delay", late),
        ("intermittent", loose),
    ],
)
def test_a_fault_is_named_told_apart_and_dated(kind, change) -> None:
    (fault,) = failed(change()).faults
    assert (fault.sensor, fault.kind) == ("A3", kind)
    assert fault.since == pytest.approx(SINCE, abs=1.5)


def test_two_exchanged_columns_are_found_from_some_moment_or_throughout() -> None:
    for first in (ONSET, 0):
        readings = flight().readings.copy()
        readings[first:, [1, 4]] = readings[first:, [4, 1]]
        (fault,) = parity_check(replace(flight(), readings=readings), block(6)[1]).faults
        assert (fault.kind, fault.suspects) == ("exchanged", ("A2", "A5"))
        assert fault.since == pytest.approx(first / RATE, abs=1.5)


def test_the_size_of_a_step_is_found_within_its_sigma() -> None:
    (fault,) = failed(later() + block(6)[0].scale[2] * 0.05).faults
    assert fault.size is not None
    assert abs(fault.size - 0.05) < 4 * (fault.sigma or 0.0) + 1e-3


def test_the_size_of_a_delay_is_that_of_quick_turns_too() -> None:
    (fault,) = failed(late()).faults
    assert fault.size == pytest.approx(LATE, abs=0.03)


def test_before_a_step_nothing_has_changed_and_after_it_its_sensor_has() -> None:
    found = failed(later() + 0.05)
    assert found.before is not None
    assert found.after is not None
    assert not found.detected
    assert (found.before.detected, found.after.isolated) == (False, "A3")


def test_a_dead_sensor_takes_no_part_in_what_follows() -> None:
    found = failed(later()[0])
    assert found.after is not None
    assert [s.name for s in found.after.sensors] == ["A1", "A2", "A4", "A5", "A6"]
    assert not found.after.detected


def test_a_sensor_dead_throughout_is_said() -> None:
    (fault,) = failed(0.0, first=0).faults
    assert (fault.sensor, fault.kind, fault.since) == ("A3", "zero", 0.0)


def test_four_sensors_show_a_fault_and_do_not_name_it() -> None:
    (fault,) = failed(later(4) + 0.1, m=4).faults
    assert fault.sensor is None
    assert set(fault.suspects) == {"A1", "A2", "A3", "A4"}
    assert fault.since == pytest.approx(SINCE, abs=1.5)


def test_two_sensors_that_fail_are_both_named() -> None:
    readings = flight(8).readings.copy()
    readings[ONSET:, 1] += 0.1
    readings[ONSET - 600 :, 6] += 0.1
    found = parity_check(replace(flight(8), readings=readings), block(8)[1])
    assert [(fault.sensor, fault.kind) for fault in found.faults] == [("A7", "step"), ("A2", "step")]


def test_faults_and_parts_are_kept_and_read_again() -> None:
    document = json.loads(json.dumps(failed(later() + 0.05).to_dict(), allow_nan=False))
    assert ParityResult.from_dict(document).to_dict() == document
