"""The analytic alignment paper: its block, its conditions, its tables. SI, 2σ where it says so."""

from dataclasses import dataclass, replace

import numpy as np

from benchmarks.papers.printed import Conditions, gyro_conditions
from estimator.applied_vector import EARTH_RATE
from estimator.results import ARCSEC
from estimator.session import StandErrors
from estimator.simulate import cone

GRAVITY = 9.81532
HOUR = np.pi / 180 / 3600
"""1 °/h in rad/s."""
LATITUDE = np.radians(55.8)
AXES = cone(6, float(np.arccos(1 / np.sqrt(3))))
"""The cone's axis along the head's: e2² = 1/3."""
STAND = StandErrors(theta_x=ARCSEC / 3, theta_y=ARCSEC / 3, alpha=ARCSEC, beta=ARCSEC)
"""δα, δβ = 3″ and θ = 1″ are three sigma."""
GYRO_STAND = replace(STAND, latitude=ARCSEC, meridian=1.5 * ARCSEC, count_time=1e-5 / 3)
"""Latitude 3″ and meridian 4.5″ (3σ), of which the paper states neither: with them (6) and (31) give its 39°."""
COUNT_TIME = 100.0
PULSE = 0.6 * ARCSEC


@dataclass(frozen=True)
class Published:
    """One of the two tables."""

    title: str
    columns: tuple[str, str, str]
    units: tuple[float, float, float]
    """Size in SI of one unit of the table: bias, relative scale, axis."""
    rows: tuple[tuple[int, float, float, float], ...]
    conditions: Conditions
    """Conditions of the first row, noise still to be fitted."""

    def at(self, positions: int, noise: float) -> Conditions:
        """The conditions of a row."""
        return replace(self.conditions, positions=positions, noise=noise)


ACCELEROMETERS = Published(
    "Table 1, accelerometers",
    ("bias, 1e-5 g", "scale, %", "axis, ″"),
    (1e-5 * GRAVITY, 0.01, ARCSEC),
    ((12, 1.2, 0.0028, 7.4), (24, 0.89, 0.0020, 5.4), (36, 0.34, 0.0008, 2.3)),
    Conditions(np.radians(40.0), 12, GRAVITY, 0.0, 2e-5 / 3 * GRAVITY, STAND),
)
GYROS = Published(
    "Table 2, gyros",
    ("drift, °/h", "scale, %", "axis, ″"),
    (HOUR, 0.01, ARCSEC),
    ((12, 0.0056, 0.036, 36.0), (24, 0.0038, 0.025, 26.0), (36, 0.0016, 0.010, 10.0)),
    gyro_conditions(Conditions(np.radians(39.0), 12, EARTH_RATE, 0.0, 0.04 / 3 * HOUR, GYRO_STAND), LATITUDE),
)
