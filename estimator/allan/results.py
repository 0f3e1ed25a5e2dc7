"""Noise of the sensors in a record at rest."""

from dataclasses import dataclass

import numpy as np
from scipy.special import gammaincinv

from estimator.codec import Document
from estimator.session import Array

TERMS = ("quantisation", "white-noise", "bias-instability", "random-walk")
"""Q, N, B and K, in the order of the times at which they show."""


@dataclass(frozen=True)
class AllanTerm:
    """One of the four noise terms."""

    name: str
    value: float | None
    """SI: m/s² (rad/s) times s for Q, √s for N, 1 for B, 1/√s for K; None where the record does not decide it."""
    sigma: float | None
    """One sigma of the value."""
    most: float | None
    """Bound on a term that is not decided, exceeded with a chance of 2.5 %; None where nothing is known."""

    def interval(self, share: float = 0.95) -> tuple[float, float] | None:
        """The interval that holds the true size with that probability; None where the record does not decide it."""
        if self.value is None or self.sigma is None:
            return None
        return interval_of(self.value, self.sigma, share)


@dataclass(frozen=True, eq=False)
class SensorNoise(Document, keys={"tau": "tau_s", "holds": "holds_s"}):
    """The noise of one sensor at rest."""

    name: str
    kind: str
    terms: tuple[AllanTerm, ...]
    """The noise terms, in the order of `TERMS`."""
    tau: Array
    """(J,) s."""
    deviation: Array
    """(J,) overlapping Allan deviation, m/s² or rad/s."""
    freedom: Array
    """(J,) effective degrees of freedom of the deviation, under the fitted terms."""
    holds: tuple[float, float] | None
    """s, from the shortest to the longest τ at which the terms describe it; None where they do nowhere."""

    def term(self, name: str) -> AllanTerm:
        """One of `TERMS`."""
        return self.terms[TERMS.index(name)]


@dataclass(frozen=True, eq=False)
class BlockNoise(Document, format="imu-noise/1", keys={"longest": "longest_s", "lasted": "lasted_s"}):
    """The noise of a block at rest."""

    rests: int
    longest: float
    """s, the longest rest."""
    lasted: float
    """s, all rests."""
    sensors: tuple[SensorNoise, ...]


def freedom_of(value: float, sigma: float) -> float:
    """Degrees of freedom of a size whose square has the relative variance 2/ν: ν = value²/(2σ²)."""
    return value**2 / (2 * sigma**2)


def interval_of(value: float, sigma: float, share: float = 0.95) -> tuple[float, float]:
    """Confidence interval of a size whose square is distributed as χ²_ν/ν times the true one; unit of the value."""
    freedom = freedom_of(value, sigma)
    low, high = 2 * gammaincinv(freedom / 2, [0.5 - share / 2, 0.5 + share / 2])
    return value * float(np.sqrt(freedom / high)), value * float(np.sqrt(freedom / low))
