"""Poses in which the stand holds the block, row by row."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from tests.blind.world import Array, Session, Site


@dataclass(frozen=True, eq=False)
class Pose:
    """R rows, rad; ``turn`` (R, 3) is a rotation vector of the block in block axes."""

    alpha: Array
    chi: Array
    beta: Array
    theta_y: Array
    meridian: Array
    flipped: Array
    turn: Array
    gravity_factor: float

    def moved(self, **by: Any) -> "Pose":
        """The pose with the named angles larger by the given amounts."""
        return replace(self, **{name: getattr(self, name) + value for name, value in by.items()})


def believed(session: Session) -> Pose:
    """The pose that the file states."""
    R = session.schedule.rows
    zero = np.zeros(R)
    return Pose(
        alpha=zero + session.stand.alpha,
        chi=zero + session.stand.chi,
        beta=session.schedule.beta,
        theta_y=zero,
        meridian=zero,
        flipped=session.schedule.flipped,
        turn=np.zeros((R, 3)),
        gravity_factor=1.0,
    )


def gravity(site: Site) -> float:
    """Helmert (1901) with the free-air term, unless g was measured; m/s²."""
    if site.gravity is not None:
        return site.gravity
    sin2 = np.sin(site.latitude) ** 2
    sin2_double = np.sin(2 * site.latitude) ** 2
    return float(9.78030 * (1 + 0.005302 * sin2 - 0.000007 * sin2_double) - 2 * 1.543e-6 * site.height)
