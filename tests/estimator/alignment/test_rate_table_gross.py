"""A gross reading on a rate table is set aside by name, and moves nothing."""

from dataclasses import replace

import numpy as np
import pytest

from estimator import rate_table
from estimator.applied_vector import EARTH_RATE
from estimator.programmes import calibrate
from estimator.session import GYROSCOPE, RATE_TABLE, Array, CalibrationSession, Sensor, Site, Stand

LATITUDE, ROW, NOISE = 0.7, 0.1, 2e-5
RATES = np.repeat([0.3, 0.0, -0.3, 0.6, -0.6], [900, 50, 900, 500, 500])
"""rad/s, of rows of 0.1 s."""


def table(rng: np.random.Generator, m: int = 4, per_rate: float = 1e4, off: float = 1e-6) -> CalibrationSession:
    """Gyros in a cone on an upright table, written down by hand: each has a bias, and a scale factor and an axis that
    are ``off`` by that much, so little that the weights of the gyros in the reduced block do not matter."""
    around = 2 * np.pi * np.arange(m) / m
    nominal = np.column_stack([np.sin(0.9) * np.cos(around), np.sin(0.9) * np.sin(around), np.full(m, np.cos(0.9))])
    axes = nominal + off * rng.standard_normal((m, 3))
    azimuth = ROW * (np.cumsum(RATES) - RATES / 2)
    level, up = EARTH_RATE * np.cos(LATITUDE), EARTH_RATE * np.sin(LATITUDE)
    rate = np.column_stack([level * np.cos(azimuth), -level * np.sin(azimuth), RATES + up])
    felt = rate @ axes.T * (1 + off * rng.standard_normal(m)) + 1e-5 * rng.standard_normal(m)
    readings = per_rate * (felt + NOISE * rng.standard_normal(felt.shape))
    return CalibrationSession(
        unit="T",
        block=GYROSCOPE,
        programme=RATE_TABLE,
        sensors=tuple(Sensor(f"G{i + 1}", GYROSCOPE, axis, per_rate, "counts") for i, axis in enumerate(nominal)),
        readings=readings,
        standard_errors=np.full(readings.shape, np.nan),
        site=Site(latitude=LATITUDE),
        stand=Stand("table"),
        time=ROW * np.arange(1, len(readings) + 1),
        turn_rate=RATES,
    )


def wrong(session: CalibrationSession, where: Array, value: Array | float, sensor: int = 1) -> CalibrationSession:
    """The session with other readings in some rows of a sensor."""
    readings = session.readings.copy()
    readings[where, sensor] = value
    return replace(session, readings=readings)


@pytest.mark.parametrize("slip", ["zero", "sign", "decimal", "tiny"])
@pytest.mark.parametrize("m", [3, 4, 6])
def test_one_gross_reading_is_named_and_moves_nothing(m: int, slip: str) -> None:
    for seed in range(5):
        rng = np.random.default_rng(seed)
        sound = table(rng, m)
        row = int(rng.choice(np.flatnonzero(RATES[:840])))
        read = sound.readings[row, 1]
        other = {"zero": 0.0, "sign": -read, "decimal": 10 * read, "tiny": read + 30 * NOISE * 1e4}[slip]
        found, plain = rate_table(wrong(sound, np.array([row]), other)), rate_table(sound)
        (aside,) = found.set_aside
        assert (aside.row, aside.sensor) == (row + 1, "G2")
        assert aside.expected == pytest.approx(read, abs=10 * NOISE * 1e4)
        assert (np.abs(found.estimate - plain.estimate) < 0.5 * np.sqrt(np.diag(plain.covariance))).all()


def test_nothing_is_named_in_a_sound_session() -> None:
    assert (
        sum(
            bool(rate_table(table(np.random.default_rng(seed), 3 + seed % 4, off=1e-3)).set_aside) for seed in range(40)
        )
        == 0
    )


@pytest.mark.parametrize("noises", [2.0, 25.0])
def test_whole_counts_coarser_than_the_noise_are_not_stuck(noises: float) -> None:
    """Every reading at one rate may be the same count."""
    for seed in range(8):
        rng = np.random.default_rng(seed)
        fine = table(rng, 3 + seed % 4)
        count = noises * NOISE * 1e4
        sound = replace(
            fine,
            readings=np.round(fine.readings / count),
            sensors=tuple(replace(s, nominal_scale=s.nominal_scale / count) for s in fine.sensors),
        )
        assert rate_table(sound).set_aside == ()
        row, size = int(rng.integers(850)), rng.choice([-1, 1]) * rng.integers(8, 10000)
        (aside,) = rate_table(wrong(sound, np.array([row]), sound.readings[row, 1] + size)).set_aside
        assert (aside.row, aside.sensor) == (row + 1, "G2")


def test_a_tenth_of_the_readings_of_one_gyro_may_be_wrong() -> None:
    rng = np.random.default_rng(3)
    sound = table(rng, 5)
    rows = rng.choice(np.flatnonzero(RATES), size=len(RATES) // 11, replace=False)
    found, plain = rate_table(wrong(sound, rows, -9e4)), rate_table(sound)
    assert {aside.sensor for aside in found.set_aside} == {"G2"}
    assert (np.abs(found.estimate - plain.estimate) < 2 * np.sqrt(np.diag(plain.covariance))).all()


def test_turns_in_which_a_gyro_stood_still_measure_nothing() -> None:
    """Stuck at the value of one rate until the end: the turns before decide, and sigma grows with what is lost."""
    outside = 0
    for seed in range(10):
        sound = table(np.random.default_rng(seed), 5)
        found, plain = rate_table(wrong(sound, np.arange(1900, len(RATES)), sound.readings[1899, 1])), rate_table(sound)
        (aside,) = found.set_aside
        assert (aside.sensor, aside.slip, aside.last_row) == ("G2", "stuck", len(RATES))
        assert found.turns < plain.turns
        outside += int((np.abs(found.estimate - plain.estimate) > 4 * np.sqrt(np.diag(found.covariance))).sum())
    assert outside == 0


@pytest.mark.parametrize("upright", [False, True])
def test_a_table_that_takes_time_to_reach_its_rate_is_no_sensors_fault(upright: bool) -> None:
    """No other sensor shows it in a block with one gyro along the turn axis."""
    sound = table(np.random.default_rng(6), 4)
    sensors = tuple(replace(s, nominal_axis=np.eye(3)[i % 3]) if upright else s for i, s in enumerate(sound.sensors))[
        : 3 if upright else 4
    ]
    along = np.array([s.nominal_axis[2] for s in sensors])
    rising = np.zeros(len(RATES))
    for first in (0, 950, 1850, 2350):
        rising[first : first + 5] = -RATES[first] * np.array([0.9, 0.7, 0.5, 0.3, 0.1])
    noise = NOISE * np.random.default_rng(7).standard_normal((len(RATES), len(along)))
    readings = 1e4 * ((RATES + rising)[:, None] * along + noise)
    given = replace(
        sound, sensors=sensors, readings=readings, standard_errors=np.full(readings.shape, np.nan), site=Site()
    )
    assert rate_table(given).set_aside == ()


def test_a_row_in_which_the_table_stumbles_is_no_sensors_fault() -> None:
    sound = table(np.random.default_rng(4), 5)
    readings = sound.readings.copy()
    readings[300] += 0.01 * 1e4 * np.array([s.nominal_axis[2] for s in sound.sensors])
    assert rate_table(replace(sound, readings=readings)).set_aside == ()


def test_what_was_set_aside_stands_in_the_calibration_and_its_document() -> None:
    given = wrong(table(np.random.default_rng(5)), np.array([99]), 0.0)
    calibration = calibrate(given)
    (aside,) = calibration.set_aside
    assert (aside.row, aside.sensor, aside.slip) == (100, "G2", "zero")
    assert rate_table(given).to_dict()["set_aside"][0]["row"] == 100
