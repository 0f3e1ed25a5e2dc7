"""Readings of every accelerometer at the stops and, piece by piece, while the table turns.

The turn axis keeps its direction, so a sensor that the turn does nothing to reads k + p·cos θ + q·sin θ, whatever the
lean of axis, block and sensor. A stop is one piece; a turn is cut where its rate is known (`levers`), so that what
starts and stops it lies within pieces and its sum is exact. θ of a turn is the gyros', stretched to the table's angle
at both ends: no delay of the table's angle enters it.
"""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from estimator.alignment.levers import Turning
from estimator.alignment.noise import LEAST_DENSITY
from estimator.alignment.positions import Stop
from estimator.session import Array

PIECE = 1.0
"""s over which the noise at the stops is taken: the filter's step."""
PIECES = 8, 40
"""Fewest and most pieces that a turn is cut into, where rows and rate allow: its scatter shows, and its shape."""
MOST = 800
"""Pieces of all turns together, about: their covariance is a full matrix, and a second's work."""


@dataclass(frozen=True, eq=False)
class Pieces:
    """Means over stops and parts of turns. N pieces, m accelerometers."""

    values: Array
    """(N, m) specific force along every input axis, m/s²."""
    level: Array
    """(N, 3) mean of 1, cos θ, sin θ, dimensionless."""
    levers: Array
    """(N, 2) contributions of one metre of c and of d, m/s² (`levers`)."""
    rate: Array
    """(N,) mean turn rate, rad/s."""
    twice: Array
    """(N, 2) mean of cos 2θ, sin 2θ, dimensionless."""
    bent: Array
    """(N, 2) mean of ω·cos θ, ω·sin θ, rad/s."""
    time: Array
    """(N,) length, s."""
    turn: NDArray[np.intp]
    """(N,) number of the turn that a piece belongs to, −1 for a stop."""
    stop: NDArray[np.intp]
    """(N,) number of the stop, −1 in a turn."""
    bend: Array
    """(N,) rad by which the mean angle may be off, because the rate bends within rows."""
    density: Array
    """(m,) density of the white noise at the stops, (m/s²)²/Hz."""

    @property
    def turns(self) -> Array:
        """(N,) 1 where the table turns, 0 where it stands, dimensionless."""
        return (self.turn >= 0).astype(float)


def pieces(inputs: Array, turned: Turning, angle: Array, stationary: list[Stop], row: float) -> Pieces:
    """The pieces of a session.

    Parameters
    ----------
    inputs : (R, m) of the accelerometers, m/s².
    turned : how the block turned.
    angle : (R,) of the table at the end of each row, rad.
    stationary : the stops.
    row : s.
    """
    stationary = [_trimmed(stop, turned) for stop in stationary]
    edges = _edges(turned, stationary)
    first = np.array([edge[0] for edge in edges])
    last = np.array([edge[1] for edge in edges])
    theta = _angle(turned, angle, stationary, row)
    rate = turned.rate
    bend = np.abs(turned.faster) * row**2 / 12
    theta = theta - turned.faster * row**2 / 12
    mean = np.sinc(rate * row / (2 * np.pi))
    cos, sin = mean * np.cos(theta), mean * np.sin(theta)
    signals = np.column_stack(
        [cos, sin, turned.columns, rate, cos**2 - sin**2, 2 * sin * cos, rate * cos, rate * sin, bend, inputs]
    )
    total = np.vstack([np.zeros(signals.shape[1]), np.cumsum(signals, axis=0)])
    means = (total[last] - total[first]) / (last - first)[:, None]
    return Pieces(
        values=means[:, 10:],
        level=np.column_stack([np.ones(len(edges)), means[:, :2]]),
        levers=means[:, 2:4],
        rate=means[:, 4],
        twice=means[:, 5:7],
        bent=means[:, 7:9],
        time=row * (last - first),
        turn=np.array([edge[2] for edge in edges]),
        stop=np.array([edge[3] for edge in edges]),
        bend=means[:, 9],
        density=_density(inputs, stationary, row),
    )


def _trimmed(stop: Stop, turned: Turning) -> Stop:
    """The stop without rows at its ends that the rate still bends into."""
    inside = np.flatnonzero(turned.known[stop.first : stop.last])
    if len(inside) < 2:
        return stop
    first = stop.first if stop.first == 0 else stop.first + int(inside[0]) + 1
    return replace(stop, first=first, last=stop.first + int(inside[-1]) + 1)


def _edges(turned: Turning, stationary: list[Stop]) -> list[tuple[int, int, int, int]]:
    """First row, one past the last, turn and stop of every piece."""
    edges, most = [], int(np.clip(MOST // max(len(stationary) - 1, 1), *PIECES))
    for number, stop in enumerate(stationary):
        if number:
            cuts = _cuts(turned, stationary[number - 1].last, stop.first, most)
            edges += [(a, b, number - 1, -1) for a, b in pairwise(cuts)]
        edges.append((stop.first, stop.last, -1, number))
    return edges


def _cuts(turned: Turning, first: int, last: int, most: int) -> list[int]:
    """Rows at which the pieces of a turn begin, ``most`` pieces or fewer, and one past its last row."""
    length = -(-(last - first) // most)
    cuts = [first]
    for end in range(first + 1, last):
        if end - cuts[-1] >= length and last - end >= length and turned.known[end - 1]:
            cuts.append(end)
    return [*cuts, last]


def _angle(turned: Turning, angle: Array, stationary: list[Stop], row: float) -> Array:
    """(R,) θ in the middle of every row, rad."""
    theta = np.concatenate([angle[:1], 0.5 * (angle[1:] + angle[:-1])])
    for stop in stationary:
        theta[stop.first : stop.last] = stop.angle
    for before, after in pairwise(stationary):
        part = turned.rate[before.last : after.first]
        ends = np.cumsum(part) * row
        if len(ends) and ends[-1]:
            stretch = (after.angle - before.angle) / ends[-1]
            theta[before.last : after.first] = before.angle + stretch * (ends - 0.5 * row * part)
    return theta


def _density(inputs: Array, stationary: list[Stop], row: float) -> Array:
    """(m,) (m/s²)²/Hz, from how means over `PIECE` scatter about a straight line at every stop; inputs (R, m), m/s²."""
    rows = max(round(PIECE / row), 1)
    squares, freedom = np.zeros(inputs.shape[1]), 0
    for stop in stationary:
        samples = inputs[stop.first : stop.last]
        means = samples[: len(samples) // rows * rows].reshape(-1, rows, inputs.shape[1]).mean(axis=1)
        if len(means) < 3:
            continue
        time = np.column_stack([np.ones(len(means)), np.linspace(-1.0, 1.0, len(means))])
        residual = means - time @ np.linalg.lstsq(time, means)[0]
        squares, freedom = squares + (residual**2).sum(axis=0), freedom + len(means) - 2
    scatter = squares / max(freedom, 1)
    return np.asarray(rows * row * scatter + LEAST_DENSITY["accelerometer"] ** 2)
