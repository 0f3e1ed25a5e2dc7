"""The faults of lives are what they are said to be, and whoever reads a faulty file refuses it or is not misled."""

import json

import numpy as np
import pytest

from estimator import SessionError, calibrate, read_session
from tests.lives.faults import WITHIN, off
from tests.lives.generator.faults import (
    FAILURES,
    GROSS,
    SICKNESSES,
    SLIPS,
    Document,
    columns,
    failing,
    gross,
    hot,
    in_counts,
    scaled,
    sick,
)
from tests.lives.units import benches

RNG = np.random.default_rng
BENCHES = benches(5)


def measured(serial: str, programme: str = "", number: int = 0) -> Document:
    programmes = BENCHES[serial].programmes
    made: Document = json.loads(json.dumps(programmes[programme or next(iter(programmes))](number)))
    return made


@pytest.mark.parametrize("slip", SLIPS)
def test_a_slip_is_in_one_sensor_and_the_rows_that_are_said(slip: str) -> None:
    sound = measured("HM-460")
    made = gross(sound, slip, RNG(1))
    before, after = columns(sound), columns(made.document)
    for name in before:
        changed = np.flatnonzero(before[name] != after[name])
        assert changed.tolist() == (list(made.rows) if name == made.sensor else [])
    off = np.abs(before[made.sensor] - after[made.sensor])[list(made.rows)]
    assert (off > GROSS * np.ptp(before[made.sensor])).all()
    assert gross(sound, slip, RNG(1)) == made


@pytest.mark.parametrize("failure", FAILURES)
def test_a_failing_sensor_fails_once_and_for_good(failure: str) -> None:
    sound = measured("FL-790", "in-service")
    document, sensor = failing(sound, failure, RNG(2))
    before, after = columns(sound), columns(document)
    changed = np.flatnonzero(before[sensor] != after[sensor])
    assert 0.3 * 600 <= changed[0] <= 0.8 * 600 + 1
    assert len(changed) == 600 - changed[0]
    assert all((before[name] == after[name]).all() for name in before if name != sensor)


def test_a_wrong_range_scales_readings_and_their_noise() -> None:
    sound = measured("HM-460")
    made = calibrate(read_session(scaled(sound, 1.05)))
    right = calibrate(read_session(sound))
    for a, b in zip(made.sensors, right.sensors, strict=True):
        assert a.scale.value == pytest.approx(1.05 * (b.scale.value or 0))
        assert a.bias.value == pytest.approx(b.bias.value, abs=1e-9)


def test_heat_moves_the_biases_alone() -> None:
    """The change is about 0.1 mg a degree."""
    sound = measured("FL-790", "in-service")
    off = [
        (a - b) / 0.12 for a, b in zip(columns(hot(sound, 45.0, RNG(3))).values(), columns(sound).values(), strict=True)
    ]
    assert np.ptp(off, axis=1) == pytest.approx(np.zeros(6), abs=1e-9)
    assert 0.005 < np.std(off) < 0.15


def test_counts_of_sixteen_bits_tell_what_volts_tell() -> None:
    sound = measured("LG-680")
    volts, counts = (calibrate(read_session(one)) for one in (sound, in_counts(sound)))
    for a, b in zip(volts.sensors, counts.sensors, strict=True):
        assert b.bias.value == pytest.approx(a.bias.value, abs=4 * (a.bias.sigma or 0))


@pytest.mark.parametrize("sickness", SICKNESSES)
@pytest.mark.parametrize("labelled", [True, False])
def test_a_sick_log_is_refused_or_tells_what_the_sound_one_tells(sickness: str, labelled: bool) -> None:
    sound = measured("LG-680", number=1)
    if not labelled:
        del sound["table"]["position"]
    holds(in_counts(sound), sick(sound, sickness, RNG(1)))


@pytest.mark.parametrize("slip", SLIPS)
@pytest.mark.parametrize("serial", ["LV-101", "LV-240", "HM-460", "MX-890"])
def test_a_gross_reading_changes_what_a_session_tells_by_little(serial: str, slip: str) -> None:
    sound = measured(serial)
    holds(sound, gross(sound, slip, RNG(1)).document)


def holds(sound: Document, faulty: Document) -> None:
    """Asserts that it is within some standard uncertainties of the sound one, unless it is refused."""
    try:
        made = calibrate(read_session(faulty))
    except SessionError:
        return
    right = calibrate(read_session(sound))
    found = {f"{s.name}.{p}": off(s, right.sensor(s.name), p) for s in made.sensors for p in PARAMETERS}
    assert {name: round(by, 1) for name, by in found.items() if by > WITHIN} == {}


PARAMETERS = ("scale", "bias", "quadratic", "axis")
