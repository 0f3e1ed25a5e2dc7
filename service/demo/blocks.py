"""The two kinds of block that are simulated: six accelerometers, or six pulse gyros, on a cone."""

from dataclasses import replace

import numpy as np

from estimator.applied_vector import EARTH_RATE, STANDARD_GRAVITY, gravity
from estimator.results import ARCSEC
from estimator.session import ACCELEROMETER, GYROSCOPE, Array, CalibrationSession, Sensor, Site, Stand, StandErrors
from estimator.simulate import cone, stand_schedule

CONE_HALF_ANGLE = float(np.arccos(1 / np.sqrt(3)))
"""54.7°: three of the axes are orthogonal."""
SITE = Site(latitude=float(np.radians(55.81)), height=160.0)
"""55.81° north, 160 m: as in the example of the documentation."""
ACCELEROMETER_SCALE = 0.12
"""V per m/s²."""
GYRO_SCALE = 1 / (0.6 * ARCSEC)
"""Pulses per rad: 0.6″ a pulse."""
COUNT_TIME = 100.0
"""s."""
MICRO_G = 9.80665e-6
"""m/s², at standard gravity."""
BIAS_REPEATABILITY = {ACCELEROMETER: 2e-5 / 3 * STANDARD_GRAVITY, GYROSCOPE: 0.04 / 3 * np.pi / 180 / 3600}
"""One sigma of the zero from position to position: 2e-5 g and 0.04 °/h are three."""
STAND_SIGMA = StandErrors(
    theta_x=ARCSEC / 3, theta_y=ARCSEC / 3, alpha=ARCSEC, beta=ARCSEC,
    latitude=ARCSEC, meridian=5 * ARCSEC, count_time=1e-5,
)  # fmt: skip


def sensors_of(kind: str, count: int) -> tuple[Sensor, ...]:
    """Equal sensors, evenly spaced on the cone about the head's axis."""
    pulses = kind == GYROSCOPE
    return tuple(
        Sensor(
            name=f"{'G' if pulses else 'A'}{i + 1}",
            kind=kind,
            nominal_axis=axis,
            nominal_scale=GYRO_SCALE if pulses else ACCELEROMETER_SCALE,
            reading_unit="pulse" if pulses else "V",
            bias_repeatability=BIAS_REPEATABILITY[kind],
        )
        for i, axis in enumerate(cone(count, CONE_HALF_ANGLE))
    )


def schedule_of(kind: str, sensors: int, stand_id: str, elevation_deg: float, positions: int) -> CalibrationSession:
    """A session of both runs still to be measured; the elevation is α, for gyros χ."""
    gyro = kind == GYROSCOPE
    angle = float(np.radians(elevation_deg))
    return stand_schedule(
        sensors_of(kind, sensors),
        Stand(stand_id, alpha=None if gyro else angle, chi=angle if gyro else None, sigma=sigma_of(kind)),
        SITE,
        positions,
        period=200.0 if gyro else 120.0,
        count_time=COUNT_TIME if gyro else None,
    )


def sigma_of(kind: str) -> StandErrors:
    """The stand's errors that act on this kind of block."""
    if kind == GYROSCOPE:
        return STAND_SIGMA
    return replace(STAND_SIGMA, latitude=0.0, meridian=0.0, count_time=0.0)


def norms_of(sensors: tuple[Sensor, ...]) -> Array:
    """(m,) the same of a block of both kinds."""
    return np.array([norms(sensor.kind, 1)[0] for sensor in sensors])


def norms(kind: str, sensors: int) -> Array:
    """(m,) length of the applied vector, m/s² or rad/s."""
    return np.full(sensors, gravity(SITE) if kind == ACCELEROMETER else EARTH_RATE)
