"""Default tolerances until an engineer sets others, and the unit type of a first session.

Accelerometers: the stability of a navigation-grade unit between calibrations. Gyros: what a calibration by the Earth's
rotation can decide; it cannot observe their quadratic term, which is therefore not judged. Nobody has confirmed the
defaults for the type: until somebody enters tolerances, a parameter whose U leaves nothing to decide by its default is
judged by three times the U of a change, and what neither session observes is not judged.
"""

from collections.abc import Iterator
from math import pi, sqrt

from estimator.applied_vector import STANDARD_GRAVITY
from estimator.results import ARCSEC, COVERAGE, Calibration
from estimator.session import ACCELEROMETER, GYROSCOPE
from service.ingest.checked import Checked
from service.sessions.expanded import expanded_of
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
TIMES_U = 3.0
"""Ratio of a tolerance to the U of a change that nobody entered: the usual one of tolerance to uncertainty, with which
a sensor without change passes at four standard deviations and one that changed fails at eight."""
NOT_JUDGED = Tolerances(None, None, None, None)
DEFAULTS = {ACCELEROMETER: ACCELEROMETER_DEFAULTS, GYROSCOPE: GYROSCOPE_DEFAULTS}
"""Default tolerances by kind of sensor."""


def named_only(name: str) -> UnitType:
    """A type of which no unit was measured yet: its sensors come with the first session."""
    return UnitType(name, "", (), (), (), NOT_JUDGED, None, revision=1, are_entered=False)


def type_of(new: Checked) -> UnitType:
    """The unit type of a first session, from its metadata and the default tolerances."""
    session = new.session
    kinds = {sensor.kind for sensor in session.sensors}
    return UnitType(
        name=new.type_name,
        block=session.block,
        sensors=tuple(sensor.name for sensor in session.sensors),
        nominal_axes=tuple((float(x), float(y), float(z)) for x, y, z in (s.nominal_axis for s in session.sensors)),
        nominal_scales=tuple(sensor.nominal_scale for sensor in session.sensors),
        tolerances=DEFAULTS[session.block],
        gyro_tolerances=GYROSCOPE_DEFAULTS if len(kinds) > 1 else None,
        revision=1,
        are_entered=False,
    )


def tolerances_of(unit_type: UnitType, reference: Calibration | None = None) -> dict[tuple[str, str], float]:
    """T by kind of sensor and parameter; defaults for a kind without tolerances in the type.

    A gyro's misalignment is a part of its axis' direction and has the tolerance of the axis. Where nobody entered
    tolerances for the type, the sensors of a ``reference`` have their own, by sensor and parameter, and their kind the
    smallest of them.
    """
    stated = {**DEFAULTS, unit_type.block: unit_type.tolerances}
    if unit_type.gyro_tolerances is not None:
        stated[GYROSCOPE] = unit_type.gyro_tolerances
    by_name = {(kind, name): getattr(tolerances, name) for kind, tolerances in stated.items() for name in PARAMETERS}
    by_name[GYROSCOPE, "misalignment"] = by_name[GYROSCOPE, "axis"]
    known = {key: tolerance for key, tolerance in by_name.items() if tolerance is not None}
    if reference is None or unit_type.are_entered:
        return known
    own = {
        place: TIMES_U * expanded if expanded > known[kind] else known[kind]
        for place, kind, expanded in _of_changes(reference)
        if kind in known
    }
    kinds = {sensor.name: sensor.kind for sensor in reference.sensors}
    of_kind = {
        (kind, parameter): min(t for (name, p), t in own.items() if (kinds[name], p) == (kind, parameter))
        for kind, parameter in {(kinds[name], parameter) for name, parameter in own}
    }
    return known | of_kind | own


def _of_changes(reference: Calibration) -> Iterator[tuple[tuple[str, str], tuple[str, str], float]]:
    """Sensor and parameter, its kind and parameter, and U of a change between two sessions like this one."""
    for sensor in reference.sensors:
        for parameter in sensor.observable:
            expanded = expanded_of(sensor, parameter, COVERAGE)
            if expanded is not None:
                yield (sensor.name, parameter), (sensor.kind, parameter), sqrt(2) * expanded
