"""Results about a sensor whose residual exceeds the stated noise or is not white."""

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtri

CHANCE = 0.1
"""Share of 1/B that white noise reaches at most: 0.08 in simulation of 11 to 49 rows (see `autocorrelation`)."""

PLAIN = 1.0
"""ln evidence from which on a residual is plainly a smooth course, beside which no cause can be distinguished: a
factor of e, below which course and noise are as likely as one another."""


@dataclass(frozen=True)
class ExcessVariance:
    """A sensor noisier than stated."""

    sensor: int
    ratio: float
    """Variance over the stated one."""
    freedom: float
    """Degrees of freedom that tell it."""
    log_evidence: float
    """ln Bayes factor against the stated noise."""
    p_family: float
    """Family-wise p-value."""
    doubtful: bool = False
    """Whether its distribution departs somewhat from that of noise."""

    @property
    def strength(self) -> float:
        """Normal deviate, in standard errors, with the same evidence."""
        return normal_deviate(self.log_evidence)


@dataclass(frozen=True)
class Autocorrelation:
    """A sensor whose residual runs smoothly along an order of its rows."""

    sensor: int
    order: str
    """The order along which it does so most."""
    log_evidence: float
    """ln Bayes factor against white noise."""
    ratio: float = 1.0
    """Variance of the residual over the stated one, where the search took it as larger."""
    excess_log_evidence: float = 0.0
    """ln evidence that it is larger."""

    @property
    def plain(self) -> bool:
        """Whether it is plainly a smooth course, so that no cause is named on the sensor."""
        return self.log_evidence > PLAIN

    @property
    def p_value(self) -> float:
        """Chance of a residual at least as smooth and as large from noise alone."""
        return float(min(1.0, CHANCE * np.exp(-self.log_evidence - self.excess_log_evidence)))

    @property
    def strength(self) -> float:
        """Normal deviate, in standard errors, with the same evidence."""
        return normal_deviate(self.log_evidence + self.excess_log_evidence)


@dataclass(frozen=True)
class UnlikeNoise:
    """A sensor whose scatter is not distributed as noise is."""

    sensor: int
    p_value: float
    """Chance of normal noise at least as far from normal (Shapiro & Wilk 1965), or as much like switching
    (`switching`).
    """
    largest: float
    """The largest residual over their root mean square."""
    of_its_kind: bool = True
    """Whether the others of its kind scatter likewise, where it states no noise."""
    switches: bool = False
    """Whether its readings switch between levels from row to row."""

    @property
    def strength(self) -> float:
        """Normal deviate, in standard errors, as unlikely."""
        return float(-ndtri(max(self.p_value, 1e-300)))


@dataclass(frozen=True)
class NoiseClaim:
    """Stated noise of sensors of a kind that their readings do not bear out."""

    kind: str
    sensors: tuple[int, ...]
    """Numbers of the sensors in the session's order."""
    ratio: float
    """Variance over the stated one."""
    freedom: float
    """Degrees of freedom that tell it."""


def normal_deviate(log_evidence: float) -> float:
    """Standard errors of a normal deviate of some ln evidence."""
    return float(np.sqrt(2 * max(log_evidence, 0.0)))
