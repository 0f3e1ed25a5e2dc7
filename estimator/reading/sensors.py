"""The sensors of a session file, and whether their nominal axes can measure a vector."""

import numpy as np

from estimator.message import say
from estimator.reading.bounds import WITHIN
from estimator.reading.columns import vector
from estimator.reading.fields import Fields
from estimator.reading.keys import COLUMNS, SENSOR, check_keys
from estimator.reading.problems import Problems, shown
from estimator.session import ACCELEROMETER, GYROSCOPE, TWO_AXIS_STAND, Array, Sensor

KINDS = (ACCELEROMETER, GYROSCOPE)
"""Kinds of sensors and of blocks."""
FEWEST = 3
"""Fewest sensors of a kind: fewer cannot measure a vector."""
MOST = 1000
"""The joint covariance has 25 elements for every two sensors; no block comes near."""
LENGTH_TOLERANCE = 1e-3
"""Tolerance on the length of an axis written with three digits; the axis is then scaled to one."""
FLATTEST = 0.01
"""Smallest ratio of the axes' singular values; below it they lie in one plane, to half a degree."""
REPEATABILITY = {ACCELEROMETER: "bias_repeatability_m_s2", GYROSCOPE: "bias_repeatability_rad_s"}
"""Key by kind."""
PULSES = frozenset({"pulse", "pulses"})
COUNTS = frozenset({"count", "counts"})
"""Reading units, in lower case, that ask gyros for a count time: pulses always, counts on a stand."""


def read_sensors(document: Fields, block: str) -> tuple[Sensor, ...]:
    """The declared sensors; records every fault of the list and of each sensor."""
    entries = document.values.get("sensors")
    if not isinstance(entries, list | tuple):
        problem = "missing" if entries is None else say("is {entries}", entries=shown(entries))
        document.add("sensors", "{problem}; give a list with one object per sensor", problem=problem)
        return ()
    if len(entries) > MOST:
        document.add("sensors", "has {entries} sensors; a block has at most {most}", entries=len(entries), most=MOST)
        return ()
    sensors = []
    for number, entry in enumerate(entries, start=1):
        if isinstance(entry, dict):
            sensors.append(_read_sensor(Fields(entry, f"sensors[{number}]", document.problems), block))
        else:
            document.problems.add(f"sensors[{number}]", "is {entry}; must be an object in braces", entry=shown(entry))
    _check_names(sensors, document.problems)
    _check_axes(sensors, block, document.problems)
    return tuple(sensors)


def check_pulses(document: Fields, sensors: tuple[Sensor, ...], programme: str) -> None:
    """Pulse gyros need their count time, and a count time needs gyros."""
    gyros = [s for s in sensors if s.kind == GYROSCOPE]
    if document.has("count_time_s"):
        if sensors and not gyros:
            document.add("count_time_s", "is for gyroscopes, and this session has none; give readings as a rate")
    elif any(g.reading_unit.lower() in (PULSES | COUNTS if programme == TWO_AXIS_STAND else PULSES) for g in gyros):
        document.add("count_time_s", "missing; gyro readings are pulses: add the count time in s")
    if document.has("counter") and not document.has("count_time_s"):
        document.add("counter", "states how pulses are counted, but count_time_s is missing; add it, or remove this")


def _read_sensor(entry: Fields, block: str) -> Sensor:
    check_keys(entry, SENSOR)
    kind = entry.choice("kind", KINDS) if entry.has("kind") else block
    return Sensor(
        name=entry.required_text("name", "give each sensor the name of its column"),
        kind=kind,
        nominal_axis=_read_axis(entry),
        nominal_scale=entry.number(
            "nominal_scale", WITHIN["sensors[].nominal_scale"], "give the reading units per m/s² or rad/s"
        ),
        reading_unit=entry.required_text("reading_unit", "give the unit of the readings, for instance V"),
        bias_repeatability=_read_repeatability(entry, kind),
        nominal_offset=entry.optional_number("nominal_offset", WITHIN["sensors[].nominal_offset"]),
        position=_read_position(entry),
    )


def _read_axis(entry: Fields) -> Array:
    axis = vector(entry, "nominal_axis", "give the three components of the input axis in block axes")
    length = float(np.linalg.norm(axis))
    if length == 0:
        entry.add("nominal_axis", "has length zero; give a unit vector")
    elif abs(length - 1) > LENGTH_TOLERANCE:
        entry.add(
            "nominal_axis",
            "has length {length}; must be a unit vector: divide it by its length",
            length=f"{length:.6g}",
        )
    return axis / length if length else axis


def _read_position(entry: Fields) -> Array | None:
    if not entry.has("position_m"):
        return None
    advice = "give the position of the sensor, three components in m, block axes"
    return vector(entry, "position_m", advice, WITHIN["sensors[].position_m"])


def _read_repeatability(entry: Fields, kind: str) -> float:
    field = REPEATABILITY[kind]
    for other, key in REPEATABILITY.items():
        if other != kind and entry.has(key):
            entry.add(
                key,
                say(
                    "is for a {other_kind}; this sensor is a {kind}, so give {field}",
                    other_kind=other,
                    kind=kind,
                    field=field,
                ),
            )
    value = entry.optional_number(field, WITHIN[f"sensors[].{field}"])
    return 0.0 if value is None else value


def _check_names(sensors: list[Sensor], problems: Problems) -> None:
    taken = set(COLUMNS) | {f"{sensor.name}_se" for sensor in sensors}
    seen: dict[str, int] = {}
    for number, name in enumerate((sensor.name for sensor in sensors), start=1):
        field = f"sensors[{number}].name"
        if name and name in seen:
            problems.add(
                field,
                "{name} is also the name of sensors[{index}]; names must differ",
                name=shown(name),
                index=seen[name],
            )
        elif name in taken:
            problems.add(
                field, "{name} is the name of another column of the table; rename the sensor", name=shown(name)
            )
        seen.setdefault(name, number)


def _check_axes(sensors: list[Sensor], block: str, problems: Problems) -> None:
    for kind in sorted({sensor.kind for sensor in sensors} or {block}):
        axes = np.array([sensor.nominal_axis for sensor in sensors if sensor.kind == kind])
        if len(axes) < FEWEST:
            problems.add(
                "sensors",
                "{axes} of kind {kind}; a block needs at least {fewest}",
                axes=len(axes),
                kind=kind,
                fewest=FEWEST,
            )
        elif np.isfinite(axes).all() and _flatness(axes) < FLATTEST:
            problems.add("sensors", "the nominal axes of kind {kind} lie in one plane; they must span space", kind=kind)


def _flatness(axes: Array) -> float:
    values = np.linalg.svd(axes, compute_uv=False)
    return float(values[-1] / values[0]) if values[0] else 1.0
