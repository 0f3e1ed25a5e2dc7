"""Blocks at rest in arbitrary orientations, otherwise: with gyros, and as logs that settle after each turn."""

import json
from typing import Any

import numpy as np

from tests.blind.world import EARTH_RATE, Array

GYRO_NOISE = 3.0
"""Noise of a row of a gyro at rest, Earth rates."""
GYRO_SCALE = 1e3
"""V per rad/s."""
ZERO = 50.0
"""Zeros of gyros, in noises of a row: cheap ones are off by more than the Earth turns."""
REST, TURN = 300, 50
"""Samples of a rest and of the turn after it."""
RATE = 50.0
"""Samples a second."""
SETTLES = 1.0
"""Seconds in which what a turn left becomes less by e."""
SHAKEN = 3.0
"""One sigma of the offset that a turn leaves on a zero where a rest begins, in noises of a sample: it shows in most
rests.
"""
SCATTER = 8.8
"""Scatter of the means of such rests about the truth, in standard errors of the rows that they were made of: these, as
much white noise of samples, and 8.7 that settles.
"""

Document = dict[str, Any]


def copied(session: Document) -> Document:
    """A copy that may be changed."""
    return dict(json.loads(json.dumps(session)))


def with_gyros(session: Document, rng: np.random.Generator) -> Document:
    """The block with three gyros at right angles. Of the Earth's axis rests tell the latitude only."""
    document = copied(session)
    sensors, table = document["sensors"], document["table"]
    inputs = np.array([table[s["name"]] for s in sensors]).T / [s["nominal_scale"] for s in sensors]
    up = inputs @ np.linalg.pinv([s["nominal_axis"] for s in sensors]).T
    up /= np.linalg.norm(up, axis=1, keepdims=True)
    north = np.cross(up, rng.standard_normal(up.shape))
    north /= np.linalg.norm(north, axis=1, keepdims=True)
    latitude, noise = np.radians(rng.uniform(25, 66)), GYRO_NOISE * EARTH_RATE
    rate = EARTH_RATE * (np.sin(latitude) * up + np.cos(latitude) * north)
    rate += noise * (ZERO * rng.standard_normal(3) + rng.standard_normal(rate.shape))
    for name, axis, readings in zip("xyz", np.eye(3), (GYRO_SCALE * rate).T, strict=True):
        sensors.append(
            {
                "name": f"G{name}",
                "kind": "gyroscope",
                "nominal_axis": axis.tolist(),
                "nominal_scale": GYRO_SCALE,
                "reading_unit": "V",
            }
        )
        table[f"G{name}"] = readings.tolist()
        table[f"G{name}_se"] = [GYRO_SCALE * noise] * len(readings)
    return document


def settling(session: Document, rng: np.random.Generator) -> Document:
    """The session's means as a log of rests: each turn leaves every zero off by another amount, which settles.

    White noise of a sample is such that it makes a mean as uncertain as the row was.
    """
    document = copied(session)
    names = [s["name"] for s in document["sensors"]]
    means = np.array([document["table"][name] for name in names]).T
    noise = np.sqrt(REST) * np.array([document["table"][f"{name}_se"][0] for name in names])
    log = np.concatenate([_rest(mean, SHAKEN * noise * rng.standard_normal(len(names))) for mean in means])
    log += noise * rng.standard_normal(log.shape)
    place = np.repeat(np.stack([np.arange(len(means)), np.full(len(means), -1)], axis=1), [REST, TURN], axis=1)
    document["table"] = {"time_s": (np.arange(len(log)) / RATE).tolist(), "position": place.ravel().tolist()}
    document["table"] |= {name: column.tolist() for name, column in zip(names, log.T, strict=True)}
    return document | {"sample_rate_hz": RATE}


def _rest(mean: Array, off: Array) -> Array:
    """(REST + TURN, m) a rest, and samples of a turn that are none."""
    decay = np.exp(-np.arange(REST) / (RATE * SETTLES))[:, None]
    turning = np.tile(mean, (TURN, 1)) + 0.1 * np.sin(np.arange(TURN))[:, None]
    return np.concatenate([mean + off * decay, turning])
