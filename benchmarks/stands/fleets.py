"""Fleets whose truth is known: whole rotations, and mountings with heavier tails than the estimator takes them to have.

A block's pose at a session is the turn of the stand, times how this block was seated, times an error of measurement.
Seatings are Student's with five degrees of freedom: now and then one is bad. What is handed on is the rotation vector
from the unit's first session, with the covariance that the errors of both sessions have.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from estimator.health.stands import StandMotion

ARCSEC = np.pi / 180 / 3600
SIGMA = 0.8 * ARCSEC
"""One sigma of a session, per component."""
TAILS = 5.0
"""Degrees of freedom of a seating."""
TURNED = np.array([0.6, 0.0, -0.8])
"""Direction of every true turn."""

Turn = Callable[[int, float], float]
"""Arcsec by which a stand is turned at a time, years."""


@dataclass(frozen=True)
class Fleet:
    """Composition of a fleet."""

    units: int
    sessions: int
    """Sessions of every unit, at random dates within three years, on the stands at random."""
    stands: int
    seating: Callable[[int, int], float]
    """Arcsec per component, of a unit on a stand."""
    turned: Turn


def motions_of(fleet: Fleet, rng: np.random.Generator) -> list[StandMotion]:
    """One fleet's common motions."""
    found = []
    for unit in range(fleet.units):
        dates = np.sort(rng.uniform(0.0, 3.0, fleet.sessions))
        places = rng.integers(fleet.stands, size=fleet.sessions)
        poses = [_pose(fleet, unit, int(s), float(t), rng) for s, t in zip(places, dates, strict=True)]
        for i, (place, date) in enumerate(zip(places, dates, strict=True)):
            value = (poses[i] * poses[0].inv()).as_rotvec()
            covariance = np.eye(3) * (2 * SIGMA**2 if i else 0.0)
            found.append(StandMotion(f"S{place}", f"U{unit}", float(date), value, covariance))
    return found


def _pose(fleet: Fleet, unit: int, stand: int, time: float, rng: np.random.Generator) -> Rotation:
    scale = fleet.seating(unit, stand) * ARCSEC * np.sqrt((TAILS - 2) / TAILS)
    seat: NDArray[np.float64] = scale * rng.standard_t(TAILS, 3)
    return (
        Rotation.from_rotvec(SIGMA * rng.standard_normal(3))
        * Rotation.from_rotvec(seat)
        * Rotation.from_rotvec(fleet.turned(stand, time) * ARCSEC * TURNED)
    )
