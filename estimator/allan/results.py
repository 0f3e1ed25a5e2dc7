"""What a record at rest says of its sensors' noise."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.special import gammaincinv

from estimator.session import Array

FORMAT = "imu-noise/1"
TERMS = ("quantisation", "white-noise", "bias-instability", "random-walk")
"""Q, N, B and K, in the order of the times at which they show."""


@dataclass(frozen=True)
class Term:
    """One of the four."""

    name: str
    value: float | None
    """SI: m/s² (rad/s) times s for Q, √s for N, 1 for B, 1/√s for K; None where the record does not decide it."""
    sigma: float | None
    """One sigma of the value."""
    most: float | None
    """Of a term that is not decided: what it hardly exceeds, with a chance of 2.5 %; None where nothing is known."""

    def interval(self, share: float = 0.95) -> tuple[float, float] | None:
        """Where the true size lies with that probability; None where the record does not decide it."""
        if self.value is None or self.sigma is None:
            return None
        return interval_of(self.value, self.sigma, share)


@dataclass(frozen=True, eq=False)
class SensorNoise:
    """The noise of one sensor at rest."""

    name: str
    kind: str
    terms: tuple[Term, ...]
    """In the order of `TERMS`."""
    tau: Array
    """(J,) s."""
    deviation: Array
    """(J,) overlapping Allan deviation, m/s² or rad/s."""
    freedom: Array
    """(J,) its effective degrees of freedom, under the fitted terms."""
    holds: tuple[float, float] | None
    """s, from the shortest to the longest τ at which the terms describe it; None where they do nowhere."""

    def term(self, name: str) -> Term:
        """One of `TERMS`."""
        return self.terms[TERMS.index(name)]


@dataclass(frozen=True, eq=False)
class BlockNoise:
    """The noise of a block at rest."""

    rests: int
    longest: float
    """s, the longest rest."""
    lasted: float
    """s, all rests."""
    sensors: tuple[SensorNoise, ...]

    def to_dict(self) -> dict[str, Any]:
        """The object imu-noise/1, SI."""
        return {
            "format": FORMAT,
            "rests": self.rests,
            "longest_s": self.longest,
            "lasted_s": self.lasted,
            "sensors": [_as_dict(sensor) for sensor in self.sensors],
        }

    @staticmethod
    def from_dict(found: Mapping[str, Any]) -> "BlockNoise":
        """What was written."""
        sensors = tuple(map(_from_dict, found["sensors"]))
        return BlockNoise(found["rests"], found["longest_s"], found["lasted_s"], sensors)


def _as_dict(sensor: SensorNoise) -> dict[str, Any]:
    curve = {"tau_s": sensor.tau, "deviation": sensor.deviation, "freedom": sensor.freedom}
    return {
        "name": sensor.name,
        "kind": sensor.kind,
        "terms": [vars(term) for term in sensor.terms],
        **{name: values.tolist() for name, values in curve.items()},
        "holds_s": sensor.holds,
    }


def _from_dict(found: Mapping[str, Any]) -> SensorNoise:
    terms = tuple(Term(**term) for term in found["terms"])
    tau, deviation, freedom = (np.array(found[name]) for name in ("tau_s", "deviation", "freedom"))
    holds = None if found["holds_s"] is None else (found["holds_s"][0], found["holds_s"][1])
    return SensorNoise(found["name"], found["kind"], terms, tau, deviation, freedom, holds)


def freedom_of(value: float, sigma: float) -> float:
    """Degrees of freedom of a size whose square has the relative variance 2/ν: ν = value²/(2σ²)."""
    return value**2 / (2 * sigma**2)


def interval_of(value: float, sigma: float, share: float = 0.95) -> tuple[float, float]:
    """Of a size whose square is distributed as χ²_ν/ν times the true one; unit of the value."""
    freedom = freedom_of(value, sigma)
    low, high = 2 * gammaincinv(freedom / 2, [0.5 - share / 2, 0.5 + share / 2])
    return value * float(np.sqrt(freedom / high)), value * float(np.sqrt(freedom / low))
