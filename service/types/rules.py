"""Default tolerances until an engineer sets others, and the unit type of a first session.

Accelerometers: the stability of a navigation-grade unit between calibrations. Gyros: what a calibration by the Earth's
rotation can decide; it cannot observe their quadratic term, which is therefore not judged. A parameter that the first
session of a type does not observe on any sensor is not judged either, until an engineer gives it a tolerance.
"""

from dataclasses import replace
from math import pi

from estimator.applied_vector import STANDARD_GRAVITY
from estimator.results import ARCSEC, Calibration
from estimator.session import ACCELEROMETER, GYROSCOPE
from service.ingest.checked import Checked
from service.sessions.records import PARAMETERS
from service.types.records import Tolerances, UnitType

ACCELEROMETER_DEFAULTS = Tolerances(
    scale=100e-6,
    bias=50e-6 * STANDARD_GRAVITY,
    quadratic=20e-6 / STANDARD_GRAVITY,
    axis=20 * ARCSEC,
)
"""100 ppm, 50 µg, 20 µg/g², 20″."""
GYROSCOPE_DEFAULTS = Tolerances(scale=1e-3, bias=0.05 * pi / 180 / 3600, quadratic=None, axis=120 * ARCSEC)
"""1000 ppm, 0.05 °/h, not judged, 120″."""
NOT_JUDGED = Tolerances(None, None, None, None)
DEFAULTS = {ACCELEROMETER: ACCELEROMETER_DEFAULTS, GYROSCOPE: GYROSCOPE_DEFAULTS}
"""Default tolerances by kind of sensor."""


def named_only(name: str) -> UnitType:
    """A type of which no unit was measured yet: its sensors come with the first session."""
    return UnitType(name, "", (), (), (), NOT_JUDGED, None, revision=1)


def type_of(new: Checked, calibration: Calibration) -> UnitType:
    """The unit type of a first session, from its metadata and the default tolerances."""
    session = new.session
    kinds = {sensor.kind for sensor in session.sensors}
    return UnitType(
        name=new.type_name,
        block=session.block,
        sensors=tuple(sensor.name for sensor in session.sensors),
        nominal_axes=tuple((float(x), float(y), float(z)) for x, y, z in (s.nominal_axis for s in session.sensors)),
        nominal_scales=tuple(sensor.nominal_scale for sensor in session.sensors),
        tolerances=_observed(session.block, calibration),
        gyro_tolerances=_observed(GYROSCOPE, calibration) if len(kinds) > 1 else None,
        revision=1,
    )


def tolerances_of(unit_type: UnitType) -> dict[tuple[str, str], float]:
    """T by kind of sensor and parameter; defaults for a kind without tolerances in the type.

    A gyro's misalignment is a part of its axis' direction and has the tolerance of the axis.
    """
    stated = {**DEFAULTS, unit_type.block: unit_type.tolerances}
    if unit_type.gyro_tolerances is not None:
        stated[GYROSCOPE] = unit_type.gyro_tolerances
    by_name = {(kind, name): getattr(tolerances, name) for kind, tolerances in stated.items() for name in PARAMETERS}
    by_name[GYROSCOPE, "misalignment"] = by_name[GYROSCOPE, "axis"]
    return {key: tolerance for key, tolerance in by_name.items() if tolerance is not None}


def _observed(kind: str, calibration: Calibration) -> Tolerances:
    """The defaults of a kind without the parameters that no sensor shows."""
    sensors = [sensor for sensor in calibration.sensors if sensor.kind == kind]
    unseen = {name: None for name in PARAMETERS if _is_unseen([sensor.observable.get(name) for sensor in sensors])}
    return replace(DEFAULTS[kind], **unseen)


def _is_unseen(observable: list[bool | None]) -> bool:
    return any(seen is not None for seen in observable) and not any(observable)
