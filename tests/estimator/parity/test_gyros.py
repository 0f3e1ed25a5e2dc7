"""Parity of gyro blocks: rates or pulses over a count time, against a calibration by the Earth's rate."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from estimator.calibration import calibrate
from estimator.parity import ParityResult, parity_check
from estimator.reading import read_session
from tests.builders import ARCSEC, Document, declared, gyro_block, response, true_sensors

DEGREE_PER_HOUR = np.pi / 180 / 3600
RATE = 10.0
SCALE = 1 / (0.6 * ARCSEC)
"""Pulses per rad."""


def gyros() -> list[Any]:
    """The true sensors of the block."""
    return true_sensors(6, prefix="G", scale=SCALE, bias=2e-8, tilt=1e-4)


def turning(seconds: float) -> np.ndarray:
    """(R, 3) slow turns about all axes, rad/s."""
    t = np.arange(int(seconds * RATE)) / RATE
    return 0.02 * np.column_stack([np.sin(t / 5), np.cos(t / 7), np.sin(t / 11 + 1)])


def recording(moved: float = 0.0, *, seed: int = 0, pulses: bool = True, seconds: float = 300.0) -> Document:
    """A recording in service; ``moved`` is the change of G3's bias in °/h."""
    sensors = gyros()
    sensors[2] = replace(sensors[2], bias=sensors[2].bias + moved * DEGREE_PER_HOUR)
    rng = np.random.default_rng(seed)
    rates = turning(seconds)
    time = 1 / RATE if pulses else 1.0
    columns = {}
    for s in sensors:
        noisy = time * (response(s, rates) + 2e-6 * s.scale * rng.standard_normal(len(rates)))
        if pulses:
            total = np.floor(np.cumsum(noisy) + rng.uniform())
            noisy = np.diff(total, prepend=0.0)
        columns[s.name] = noisy.tolist()
    document = {
        "format": "imu-session/1",
        "unit": "BG-004",
        "block": "gyroscope",
        "programme": "in-service",
        "started_at": "2026-05-01T09:00:00Z",
        "sample_rate_hz": RATE,
        "sensors": declared(sensors, "pulse" if pulses else "V", bias_repeatability_rad_s=6e-8),
        "table": columns,
    }
    return document | ({"count_time_s": time} if pulses else {})


def checked(document: Document) -> ParityResult:
    """Checks a recording against the block's calibration; a rate gyro's has no count time either."""
    pulses = "count_time_s" in document
    reference = calibrate(
        read_session(gyro_block(sensors=gyros(), count_time_s=100.0 if pulses else None, se=0.3 if pulses else 3e-3))
    )
    return parity_check(read_session(document), reference)


@pytest.mark.parametrize("pulses", [True, False])
def test_an_unchanged_block_agrees(pulses: bool) -> None:
    assert not any(checked(recording(seed=seed, pulses=pulses)).detected for seed in range(5))


@pytest.mark.parametrize("pulses", [True, False])
def test_a_drifted_gyro_is_found_named_and_measured(pulses: bool) -> None:
    found = checked(recording(2.0, pulses=pulses))
    bias = found.sensor("G3").bias
    assert found.isolated == "G3"
    assert bias.size is not None
    assert bias.sigma is not None
    assert abs(bias.size - 2.0 * DEGREE_PER_HOUR) < 4 * bias.sigma


def test_pulses_over_another_time_are_the_same_rates() -> None:
    slow = recording(2.0, seconds=600.0)
    joined = {name: np.array(counts).reshape(-1, 2).sum(axis=1).tolist() for name, counts in slow["table"].items()}
    halved = slow | {"table": joined, "count_time_s": 0.2, "sample_rate_hz": 5.0}
    fast, other = (checked(document).sensor("G3").bias.size for document in (slow, halved))
    assert fast == pytest.approx(other, rel=0.05)
