"""Accelerations that accelerometers off the turn axis feel, and the mean rate of turn over each row.

A sensor with input axis a at position r from the turn axis (block axes, Z the turn axis) feels, while the table turns
at ω with the angular acceleration α, besides gravity

    a·(ω×(ω×r) + α×r) = −ω²·c + α·d,   c = a_x r_x + a_y r_y,   d = a_y r_x − a_x r_y.

c is the part of r along the input axis, d the part across it, each times the horizontal share of the axis; r_z takes no
part, and a sensor whose axis is upright feels nothing. From c and d the horizontal position follows,
r_x = (a_x c + a_y d)/h², r_y = (a_y c − a_x d)/h², h² = a_x² + a_y². What the Earth's horizontal rotation adds to ω is
below 0.1 µg and left out; its upright part is in the gyros' ω.

A row's reading is a mean, so ⟨ω²⟩ and ⟨α⟩ are. Of a rate that changes evenly between the ends of a row, w₀ and w₁, they
are (w₀² + w₀w₁ + w₁²)/3 and (w₁ − w₀)/Δt. The gyros' azimuth says the mean rate of every row on the readings' own clock
and without an encoder's last digit; an end between two rows has the mean of both. Where the rate bends within a row
that is not exact; the bend is over after a few rows, and what they add up to is exact again.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from estimator.alignment.axes import scatter
from estimator.session import ACCELEROMETER, Array, CalibrationSession, Sensor

BENT = 0.01
"""Part of the fastest rate by which the rate may change over four rows for the rate between them to count as known:
what is then unknown of it, times a lever arm, is below what the noise of good accelerometers adds to a velocity."""
CHANCE = 6.0
"""Sigmas of the gyros' noise that four rows may differ by beside that: once in a million rows they do by chance."""
FARTHEST = 1.0
"""m, one sigma of a lever arm before the session: more than the tables that turn a block by hand or motor hold."""
UPRIGHT = 0.05
"""Horizontal share of an input axis below which a sensor counts as upright, and its lever arm as not seen: 3°, what a
turn axis may lean."""


@dataclass(frozen=True, eq=False)
class Turning:
    """Rotation of the block in every row. R rows."""

    rate: Array
    """(R,) ⟨ω⟩, rad/s."""
    square: Array
    """(R,) ⟨ω²⟩, (rad/s)²."""
    faster: Array
    """(R,) ⟨α⟩, rad/s²."""
    known: NDArray[np.bool_]
    """(R,) whether the rate at the end of the row is known: it does not bend there."""

    @property
    def columns(self) -> Array:
        """(R, 2) contributions of one metre of c and of d to each row, m/s²."""
        return np.column_stack([-self.square, self.faster])


def turning(rate: Array, row: float) -> Turning:
    """The turning of a block whose mean rates about Z over rows of ``row`` s are (R,), rad/s."""
    ends = np.concatenate([rate[:1], 0.5 * (rate[1:] + rate[:-1]), rate[-1:]])
    before, after = ends[:-1], ends[1:]
    spread = np.square(after - before) / 12
    padded = np.concatenate([rate[:1], rate, rate[-1:], rate[-1:]])
    four = np.stack([padded[k : k + len(rate)] for k in range(4)])
    noise = float(np.sqrt(scatter(rate[:, None])[0]))
    known = np.ptp(four, axis=0) <= BENT * np.abs(rate).max() + CHANCE * noise
    return Turning(rate, rate**2 + spread, (after - before) / row, known)


def coefficients(axes: Array, positions: Array) -> Array:
    """(m, 2) c and d, m, of sensors with axes (m, 3), dimensionless, at positions (m, 3), m, from the turn axis."""
    along = (axes[:, :2] * positions[:, :2]).sum(axis=1)
    across = axes[:, 1] * positions[:, 0] - axes[:, 0] * positions[:, 1]
    return np.column_stack([along, across])


def place_of(axis: Array) -> Array:
    """(2, 2) matrix from (c, d) of a sensor with input axis (3,), dimensionless, to its (r_x, r_y), m per m."""
    a_x, a_y = axis[:2]
    return np.array([[a_x, a_y], [a_y, -a_x]]) / (a_x**2 + a_y**2)


def positions_of(sensors: Sequence[Sensor]) -> Array | None:
    """(m, 3) where accelerometers sit, m; None unless the file states it of all of them."""
    places = [sensor.position for sensor in sensors if sensor.kind == ACCELEROMETER]
    return None if any(place is None for place in places) else np.array(places)


def without_lever_arms(session: CalibrationSession, rate: Array, row: float) -> CalibrationSession:
    """The session without what accelerometers at stated positions feel of turns.

    rate : (R,) mean over rows of ``row`` s, rad/s.

    Positions count from any one origin: where the turn axis passes is left to the estimate.
    """
    places = positions_of(session.sensors)
    if places is None:
        return session
    chosen = [i for i, sensor in enumerate(session.sensors) if sensor.kind == ACCELEROMETER]
    axes = np.stack([session.sensors[i].nominal_axis for i in chosen])
    scale = np.array([session.sensors[i].nominal_scale for i in chosen])
    readings = session.readings.copy()
    readings[:, chosen] -= scale * (turning(rate, row).columns @ coefficients(axes, places).T)
    return replace(session, readings=readings)
