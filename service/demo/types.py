"""The unit types of the demonstration fleet and their tolerances."""

from math import pi

from estimator.applied_vector import STANDARD_GRAVITY
from estimator.results import ARCSEC
from estimator.session import ACCELEROMETER, GYROSCOPE
from service.demo.blocks import sensors_of
from service.types.records import Tolerances, UnitType

SENSORS = 6
"""On every cone, as in the published block."""
TYPE_NAME = {ACCELEROMETER: "RA-6", GYROSCOPE: "RG-6"}
"""By kind of sensor."""
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
