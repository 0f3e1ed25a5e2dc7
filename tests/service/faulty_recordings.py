"""Recordings in which a sensor begins to fail, made of those of `tests.service.recordings` reading by reading."""

import json
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from tests.builders import Array
from tests.service.recordings import RATE, recording_document

BEGINS = 120.0
"""s, the middle of a recording."""
SCALE, G = 0.12, 9.80665
"""V per m/s² of every sensor, and m/s²."""
Spoil = Callable[[Array, Array, np.random.Generator], Array]
"""Turns the readings (n,) since a sensor fails, V, and s since then, into what it gives instead."""
SPOILT: Mapping[str, Spoil] = {
    "step": lambda u, t, rng: u + 0.1 * G * SCALE,
    "ramp": lambda u, t, rng: u + 1e-3 * G * SCALE * t,
    "stuck": lambda u, t, rng: np.full_like(u, u[0]),
    "zero": lambda u, t, rng: np.zeros_like(u),
    "full-scale": lambda u, t, rng: np.full_like(u, 5.0),
    "gain": lambda u, t, rng: 1.05 * u,
    "noise": lambda u, t, rng: u + 0.02 * G * SCALE * rng.standard_normal(len(u)),
    "delay": lambda u, t, rng: np.interp(t - 0.35, t, u),
    "intermittent": lambda u, t, rng: u + 0.1 * G * SCALE * (rng.random(len(u) // 30 + 1).repeat(30)[: len(u)] < 0.3),
}


def faulty_bytes(kind: str, *, sensor: str = "A3", since: float = BEGINS, **changes: Any) -> bytes:
    """A recording whose sensor fails from a time on, s; ``exchanged``: A1 and A4 are. ``changes`` are those of
    `recording_document`."""
    document = recording_document(**changes)
    table = {name: np.array(column) for name, column in document["table"].items()}
    row = round(since * RATE)
    if kind == "exchanged":
        table["A1"][row:], table["A4"][row:] = table["A4"][row:].copy(), table["A1"][row:].copy()
    else:
        readings = table[sensor][row:]
        table[sensor][row:] = SPOILT[kind](readings, np.arange(len(readings)) / RATE, np.random.default_rng(5))
    return json.dumps(document | {"table": {name: column.tolist() for name, column in table.items()}}).encode()
