"""The two kinds of block that are simulated: six accelerometers, or six pulse gyros, on a cone."""

from dataclasses import dataclass, replace
from math import pi

import numpy as np

from estimator.applied_vector import EARTH_RATE, STANDARD_GRAVITY, gravity
from estimator.causes import Signature, cause
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.hiding import with_input
from estimator.results import ARCSEC
from estimator.session import ACCELEROMETER, GYROSCOPE, Array, CalibrationSession, Sensor, Site, Stand, StandErrors
from estimator.simulate import cone, stand_schedule
from service.types.records import Tolerances, UnitType

CONE_HALF_ANGLE = float(np.arccos(1 / np.sqrt(3)))
"""54.7°: three of the axes are orthogonal."""
SITE = Site(latitude=float(np.radians(55.81)), height=160.0)
"""55.81° north, 160 m: as in the example of the documentation."""
ACCELEROMETER_SCALE = 0.12
"""V per m/s²."""
GYRO_SCALE = 1 / (0.6 * ARCSEC)
"""Pulses per rad: 0.6″ a pulse."""
COUNT_TIME = 100.0
"""Time over which pulses are counted, s."""
ELEVATION_DEG = 40.0
"""Elevation of the head, degrees, in the demonstration fleet and in `imu-health simulate`."""
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


SENSORS = 6
"""Sensors on every cone, as in the published block."""
TYPE_NAME = {ACCELEROMETER: "RA-6", GYROSCOPE: "RG-6"}
"""Unit type by kind of sensor."""
TOLERANCES = {
    ACCELEROMETER: Tolerances(
        scale=100e-6, bias=50e-6 * STANDARD_GRAVITY, quadratic=40e-6 / STANDARD_GRAVITY, axis=20 * ARCSEC
    ),
    GYROSCOPE: Tolerances(scale=3e-3, bias=0.03 * pi / 180 / 3600, quadratic=None, axis=600 * ARCSEC),
}
"""100 ppm, 50 µg, 40 µg/g², 20″; 3000 ppm, 0.03 °/h, not judged, 600″."""


def unit_type(kind: str) -> UnitType:
    """The type of every unit of this kind."""
    sensors = sensors_of(kind, SENSORS)
    return UnitType(
        name=TYPE_NAME[kind],
        block=kind,
        sensors=tuple(sensor.name for sensor in sensors),
        nominal_axes=tuple((float(x), float(y), float(z)) for x, y, z in (s.nominal_axis for s in sensors)),
        nominal_scales=tuple(sensor.nominal_scale for sensor in sensors),
        tolerances=TOLERANCES[kind],
        gyro_tolerances=None,
        revision=1,
    )


ELEMENT = {"scale": 0, "bias": 1, "quadratic": 2, "axis": 3}
"""Place in the step of five; an axis turns along its first tangent."""
MICRO = 1e-6
"""ppm, µg and µg/g² in parts of one."""
DEGREE_PER_HOUR = np.pi / 180 / 3600 / EARTH_RATE
"""One °/h as a fraction of the Earth's rate."""


@dataclass(frozen=True)
class ParameterMove:
    """Change of one parameter of one sensor: ppm, µg (gyro: °/h), µg/g², arcsec."""

    sensor: int
    """Number of the sensor, from 0."""
    parameter: str
    amount: float


def step_of(changes: tuple[ParameterMove, ...], sensors: int, kind: str) -> Array:
    """(m, 5) the changes added up, dimensionless."""
    bias = MICRO if kind == ACCELEROMETER else DEGREE_PER_HOUR
    factor = {"scale": MICRO, "bias": bias, "quadratic": MICRO, "axis": ARCSEC}
    step = np.zeros((sensors, 5))
    for change in changes:
        step[change.sensor, ELEMENT[change.parameter]] += change.amount * factor[change.parameter]
    return step


@dataclass(frozen=True)
class DemoEffect:
    """One effect in a member's latest session."""

    cause: str
    amplitude: tuple[float, ...]
    """SI, as the catalogue counts it."""
    sensor: int | None = None
    """Counted from 0; None for an effect of the stand."""


def with_effect(session: CalibrationSession, hidden: DemoEffect) -> CalibrationSession:
    """The session with the effect in its readings."""
    setting, known = baseline_of(session).setting, cause(hidden.cause)
    assert isinstance(known, Signature)
    place = () if hidden.sensor is None else (hidden.sensor,)
    shape = next(shape for shape in known.shapes(setting) if shape.sensors == place)
    added = shape.columns @ np.array(hidden.amplitude)
    return with_input(session, setting, added)
