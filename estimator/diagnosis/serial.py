"""Left-overs that are no pattern of ours and still not noise: neighbours in some order resemble one another.

The ratio of mean squared successive differences to the mean square (von Neumann 1941) is two for white noise and small
for anything smooth in the order taken: time, temperature, β, the sensor's own input. Its distribution is that of
random orders of the same left-overs (Abbe): mean 2, variance 4·(n − 2)/(n² − 1) to good accuracy.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr

from estimator.diagnosis.evidence import Evidence
from estimator.session import Array

FEWEST = 12
"""Rows below which smoothness cannot be told from chance."""


@dataclass(frozen=True)
class Serial:
    """One sensor whose left-over runs smoothly along an order of its rows."""

    sensor: int
    order: str
    p_value: float
    strength: float
    """Deviation of the ratio from white noise, in its standard errors."""


def orders(evidence: Evidence, sensor: int) -> dict[str, Array]:
    """The orders in which a left-over may run smoothly: (R,) keys to sort by."""
    setting = evidence.baseline.setting
    keys = {"the order measured": np.arange(setting.rows, dtype=float), "the sensor's input": setting.a[:, sensor]}
    if setting.temperature is not None and len(np.unique(setting.temperature)) >= 6:
        keys["temperature"] = setting.temperature
    if setting.beta is not None:
        keys["β"] = np.mod(setting.beta, 2 * np.pi)
    return keys


def serial_structure(evidence: Evidence, left: Array, sensor: int, level: float) -> Serial | None:
    """The order along which one sensor's left-over is smoothest, if chance does not explain it."""
    R, m = evidence.baseline.residual.shape
    own = left[: R * m].reshape(R, m)[:, sensor]
    square = float((own**2).mean())
    if R < FEWEST or square <= 0:
        return None
    keys = orders(evidence, sensor)
    spread = np.sqrt(4 * (R - 2) / (R**2 - 1))
    best = None
    for name, key in keys.items():
        sorted_ = own[np.argsort(key, kind="stable")]
        ratio = float((np.diff(sorted_) ** 2).mean()) / square
        strength = (2 - ratio) / spread
        p_value = min(1.0, float(ndtr(-strength)) * len(keys))
        if p_value < level and (best is None or p_value < best.p_value):
            best = Serial(sensor, name, p_value, strength)
    return best
