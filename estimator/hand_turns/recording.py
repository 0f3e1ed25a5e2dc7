"""The measured side: the samples of a log, its rests, and the directions of gravity in them."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from estimator.session import Array

Mask = np.ndarray


@dataclass(frozen=True, eq=False)
class RestDirections:
    """Directions of up in R rests, as the calibrated accelerometers give them, with their joint covariance."""

    up: Array
    """(R, 3) unit vectors, block axes."""
    tangents: Array
    """(R, 3, 2) along which the directions turn, dimensionless."""
    covariance: Array
    """(2R, 2R) rad², of these turns, rest after rest: the readings' noise and the accelerometers' parameters, which all
    rests share."""


@dataclass(frozen=True, eq=False)
class TurnedLog:
    """A log of R rests with turns between them, of m gyros; N samples."""

    readings: Array
    """(N, m) rad/s by the nominal scale, nominal offset taken off; no gaps."""
    force: Array
    """(N, 3) specific force as the calibrated accelerometers read it, m/s², block axes."""
    step: float
    """s from sample to sample."""
    start: Array
    """(R,) first sample of each rest."""
    stop: Array
    """(R,) one past its last."""
    seen: tuple[Array, Array]
    """(R,) first sample and one past the last of the rests as the directions are means over them: the same, or a little
    of the turns with them."""
    whole: Array
    """(R − 1,) bool: turns of which no sample is missing."""
    rest: Array
    """(R, m) mean reading of each rest, rad/s by the nominal scale."""
    rest_sigma: Array
    """(R, m) one sigma of it, rad/s; beyond `WEIGHTLESS` where it takes no part."""
    noise: Array
    """(m,) variance of one sample, were they independent, of the same sum over some seconds, (rad/s)²."""
    axes: Array
    """(m, 3) nominal axes, unit vectors, block axes."""
    latitude: float | None
    """rad; None where it is not known."""
    gravity: float
    """m/s²"""

    @cached_property
    def turning(self) -> Array:
        """(N,) bool: samples between the first and the last rest that lie in none."""
        change = np.zeros(len(self.readings) + 1, dtype=np.int64)
        np.add.at(change, self.stop[:-1], 1)
        np.add.at(change, self.start[1:], -1)
        return np.asarray(np.cumsum(change)[:-1] > 0)

    @cached_property
    def edges(self) -> Array:
        """(2R − 2,) where turns begin and end, for sums over each."""
        return np.stack([self.stop[:-1], self.start[1:]], axis=1).ravel()

    def sums(self, values: Array) -> Array:
        """(R − 1, …) sums of values (N, …), of any unit, over each turn."""
        return np.asarray(np.add.reduceat(values, self.edges, axis=0)[::2])

    @cached_property
    def samples(self) -> Array:
        """(R − 1,) samples of each turn."""
        return np.asarray(self.start[1:] - self.stop[:-1])
