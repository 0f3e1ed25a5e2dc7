"""Every way in which a sensor fails within a recording has its sentence and its one action."""

import json
from dataclasses import replace
from functools import cache

import pytest

from estimator import calibrate, read_session
from estimator.parity import CourseFault, ParityResult, parity_check
from service.judging.fault_words import faults_in_words, remedy_in, said_of
from service.judging.parity_words import parts_in_words
from tests.service.made_sessions import session_bytes
from tests.service.recordings import recording_document

MG = 9.80665e-3
STARTED = "2026-05-01T09:00:00Z"
SINCE = "since 09:02:00 UTC (120 s into the recording)"
STUCK = CourseFault("A3", ("A3",), "stuck", 120.0, None, 0.05, None, None, 1e-9)
CHANNEL = "replace or repair A3, and check its channel and its plug"


@cache
def sound() -> ParityResult:
    reference = calibrate(read_session(json.loads(session_bytes())))
    return parity_check(read_session(recording_document(seconds=60)), reference)


def said(*faults: CourseFault, started_at: str | None = STARTED, **changes) -> str:
    return said_of(faults_in_words(replace(sound(), faults=faults, **changes), started_at))


@pytest.mark.parametrize(
    ("kind", "size", "sentence"),
    [
        ("stuck", None, f"A3 has stood still {SINCE}: {CHANNEL}."),
        ("zero", 5 * MG, f"A3 has read zero {SINCE}: {CHANNEL}."),
        ("full-scale", 5 * MG, f"A3 has stood at the end of its range {SINCE}: {CHANNEL}."),
        ("step", 100 * MG, f"The bias of A3 has been off by +100.0 ± 2.0 mg {SINCE}: replace or repair A3."),
        (
            "ramp",
            -MG / 6,
            f"The bias of A3 has been drifting by −10.00 ± 0.20 mg per minute {SINCE}: replace or repair A3.",
        ),
        ("gain", 0.05, f"The scale factor of A3 has been off by +5.00 ± 0.10 % {SINCE}: replace or repair A3."),
        (
            "noise",
            20 * MG,
            f"A3 has been too noisy, with 20.00 ± 0.40 mg a sample, {SINCE}: check the mounting and the supply of A3; "
            "replace it if both are sound.",
        ),
        (
            "delay",
            0.2,
            f"The readings of A3 have come late by 200.0 ± 4.0 ms {SINCE}: check the filter and the sampling of the "
            "channel of A3.",
        ),
        (
            "intermittent",
            50 * MG,
            f"A3 has been off now and then by +50.0 ± 1.0 mg {SINCE}: check the connector of A3.",
        ),
    ],
)
def test_every_kind_is_said_with_its_action(kind: str, size: float | None, sentence: str) -> None:
    sigma = None if size is None else abs(size) / 100
    text = said(replace(STUCK, kind=kind, size=size, sigma=sigma))
    assert text.replace("\xa0", " ").replace("\u202f", " ") == sentence


def test_two_exchanged_sensors_are_both_named_and_the_file_is_to_be_corrected() -> None:
    text = said(replace(STUCK, kind="exchanged", suspects=("A1", "A4")))
    assert text == (
        f"A1 and A4 have been exchanged {SINCE}: check the wiring and the columns of A1 and A4, and upload the "
        "recording again corrected."
    )


def test_a_sensor_that_cannot_be_named_is_one_of_several() -> None:
    text = said(replace(STUCK, kind="step", sensor=None, suspects=("A1", "A2", "A3", "A4"), size=None))
    assert text == (
        f"The bias of one of the sensors A1, A2, A3, A4 has been off {SINCE}; the redundancy is too small to say "
        "which: calibrate the unit to find the sensor, and replace or repair it."
    )


def test_a_size_that_nobody_can_tell_is_not_said() -> None:
    assert said(replace(STUCK, kind="gain")).startswith(f"The scale factor of A3 has been off {SINCE}:")


@pytest.mark.parametrize(
    ("fault", "started_at", "when"),
    [
        (STUCK, None, "since 120 s into the recording:"),
        (replace(STUCK, since_sigma=1.6), None, "since 120 ± 3 s into the recording:"),
        (replace(STUCK, until=180.0), STARTED, f"{SINCE.replace('since', 'from')} to 09:03:00 UTC (180 s into the"),
        (replace(STUCK, since=0.0), STARTED, "throughout the recording:"),
        (replace(STUCK, since=86_400.0), STARTED, "since 09:00:00 UTC on 2 May 2026 (86\u202f400 s into"),
    ],
)
def test_when_is_said_by_the_clock_where_that_is_known(fault: CourseFault, started_at: str | None, when: str) -> None:
    assert when in said(fault, started_at=started_at).replace("\xa0", " ")


def test_without_a_rate_rows_are_counted() -> None:
    assert "since row 121 of the recording" in said(STUCK, block_seconds=None)


def test_of_several_faults_the_first_says_what_to_do() -> None:
    text = said(STUCK, replace(STUCK, sensor="A5", suspects=("A5",), kind="intermittent", since=150.0))
    assert text.startswith(f"A3 has stood still {SINCE}: {CHANNEL}. A5 has been off now and then since 09:02:30 UTC")
    assert remedy_in(text) == CHANNEL


def test_the_parts_before_and_after_are_said_in_a_line_each() -> None:
    without = replace(sound(), sensors=tuple(s for s in sound().sensors if s.name != "A3"))
    assert parts_in_words(replace(sound(), faults=(STUCK,), before=sound(), after=without)) == (
        "Before that: no change since the calibration.",
        "From then on, without A3: nothing else has changed since the calibration.",
    )
    assert parts_in_words(replace(sound(), faults=(STUCK,)))[1] == "From then on: too little to be judged."
    assert parts_in_words(sound()) == ()
