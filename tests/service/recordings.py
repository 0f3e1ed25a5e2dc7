"""Recordings in service of the unit of `tests.service.made_sessions`, as bytes."""

import json
from dataclasses import replace
from typing import Any
from zlib import crc32

import numpy as np

from tests.builders import Array, Document, declared, response, true_sensors
from tests.service.made_sessions import MICRO_G

RATE = 10.0
NOISE = 6e-6
"""V a sample, 5 µg."""


def manoeuvre(seconds: int) -> Array:
    """(R, 3) specific force of slow turns about all axes with some thrust, m/s²."""
    t = np.arange(int(seconds * RATE)) / RATE
    turning = np.column_stack([np.sin(2 * np.pi * t / 37), np.sin(2 * np.pi * t / 53 + 1), np.cos(2 * np.pi * t / 71)])
    return 9.8 * turning / np.linalg.norm(turning, axis=1, keepdims=True) * (1 + 0.3 * np.sin(t / 9))[:, None]


def recording_document(
    *, seed: int = 9, unit: str = "BA-017", m: int = 6, seconds: int = 240, a3_moved: float = 0.0, still: bool = False
) -> Document:
    """A recording of the sensors of `session_bytes`; ``a3_moved`` is the change of A3's bias in µg."""
    sensors = true_sensors(m, bias=1e-3, quadratic=1e-6, tilt=1e-4)
    sensors[2] = replace(sensors[2], bias=sensors[2].bias + a3_moved * MICRO_G)
    rng = np.random.default_rng(seed if unit == "BA-017" else seed + 1000 * crc32(unit.encode()))
    force = manoeuvre(seconds)
    if still:
        force = np.tile(9.81532 * np.array([0.36, 0.48, 0.8]), (len(force), 1))
    columns = {s.name: response(s, force) + NOISE * rng.standard_normal(len(force)) for s in sensors}
    return {
        "format": "imu-session/1",
        "unit": unit,
        "block": "accelerometer",
        "programme": "in-service",
        "started_at": "2026-05-01T09:00:00Z",
        "sample_rate_hz": RATE,
        "sensors": declared(sensors, "V", position_m=[0.0, 0.0, 0.0]),
        "table": {name: column.tolist() for name, column in columns.items()},
    }


def recording_bytes(**changes: Any) -> bytes:
    """`recording_document` as JSON."""
    return json.dumps(recording_document(**changes)).encode()
