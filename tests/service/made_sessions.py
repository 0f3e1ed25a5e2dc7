"""Session files of one unit, as bytes, for the tests of the service."""

import json
from dataclasses import replace
from hashlib import sha256
from typing import Any
from zlib import crc32

from tests.builders import accelerometer_block, true_sensors

MICRO_G = 9.80665e-6


def session_bytes(
    *,
    seed: int = 1,
    unit: str = "BA-017",
    month: int = 3,
    a3_moved: float = 0.0,
    m: int = 6,
    se: float = 3e-6,
    **changes: Any,
) -> bytes:
    """A session of 2026, each unit with noise of its own; ``a3_moved`` is the change of A3's bias in µg, ``se`` the
    standard error of a reading, V; ``changes`` replace fields of the file."""
    sensors = true_sensors(m, bias=1e-3, quadratic=1e-6, tilt=1e-4)
    sensors[2] = replace(sensors[2], bias=sensors[2].bias + a3_moved * MICRO_G)
    noise = seed if unit == "BA-017" else seed + 1000 * crc32(unit.encode())
    document = accelerometer_block(m, seed=noise, unit=unit, sensors=sensors, positions=24, se=se)
    return json.dumps(document | {"started_at": f"2026-{month:02d}-01T09:00:00Z"} | changes).encode()


def session_id(content: bytes) -> str:
    """The id under which the service keeps a file."""
    return sha256(content).hexdigest()[:20]


FAILED = (session_bytes(month=1), session_bytes(seed=2, month=2, a3_moved=90.0))
"""A unit's reference session, and one in which A3's bias is out of tolerance."""


def in_counts(unit: str, counts_a_volt: float, rounding: float = 1.0, **session: Any) -> bytes:
    """A session of a unit whose readings are counts of a converter."""
    document = json.loads(session_bytes(unit=unit, **session))
    sensors = [
        s | {"reading_unit": "LSB", "nominal_scale": s["nominal_scale"] * counts_a_volt * rounding}
        for s in document["sensors"]
    ]
    names = {s["name"] for s in sensors} | {f"{s['name']}_se" for s in sensors}
    table = {
        name: [value * counts_a_volt for value in column] if name in names else column
        for name, column in document["table"].items()
    }
    return json.dumps(document | {"sensors": sensors, "table": table}).encode()
