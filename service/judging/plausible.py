"""Step: before a session is judged or becomes a reference: can it be as its file states?

Scale factors, axes, signs, noise and date are compared with the file's own nominal values and the unit's reference, or,
before it has one, with the other units of its type (`beside_type`); its date with the unit's other sessions
(`moments`). Temperature and gravity are compared with the limits of the Earth when the file is read. Only values that
no sensor and no stand can produce are doubted: a doubt is a mistake in the file, not a fault of the unit, which its
tolerances judge.
"""

from collections.abc import Collection, Iterator, Sequence

import numpy as np

from estimator.applied_vector import STANDARD_GRAVITY
from estimator.calibration.gross_slips import STUCK
from estimator.message import joined, say
from estimator.results import Calibration, SensorCalibration
from estimator.session import ACCELEROMETER, CALIBRATIONS, GYROSCOPE, IN_SERVICE, Array, Sensor
from service.ingest.checked import Checked
from service.judging.beside_type import ANOTHER, MOST, beside_type, type_of_references
from service.judging.origin import of_date, of_moment, of_unit
from service.judging.reference import KnownUnit
from service.kit.measures import in_words
from service.sessions.doubt import Doubt, FileCorrection, Remedy
from service.sessions.history_store import History
from service.storage.queries import Store
from service.types.records import UnitType
from service.types.rules import tolerances_of
from service.types.store import UnitTypes

LEAST_RATIO = 2.0
"""Least ratio of a scale factor to its nominal: makers state it within some percent, and no sensor loses half of it and
works.
"""
LIKE = 1.2
"""Ratios within this factor of one another are one slip; nominal values are rounded."""
THOUSANDS = (1e3, 1e-3, 1e6, 1e-6)
IN_G = (STANDARD_GRAVITY, 1 / STANDARD_GRAVITY)
IN_DEGREES = (180 / np.pi, np.pi / 180)
FAR, NEAR = np.cos(np.radians(20.0)), np.cos(np.radians(10.0))
"""An input axis lies within some degrees of its nominal one: beyond 20° it is another one, within 10° it is that."""
ROUNDED = np.cos(np.radians(1.0))
"""A nominal axis is written to a degree or better."""
LARGEST_BIAS = {ACCELEROMETER: 2 * STANDARD_GRAVITY, GYROSCOPE: np.radians(100.0)}
"""m/s² (rad/s): ten times what makers allow of the coarsest sensors, 0.2 g and 10 °/s."""
WITHOUT_OFFSET = frozenset({"m/s²", "m/s^2", "m/s2", "g", "mg", "µg", "rad/s", "°/s", "deg/s", "dps", "°/h", "deg/h"})
"""Units of readings in physical terms: raw ones may have an offset of half the range."""
MOST_ROWS = 10_000
"""Most rows of a recording, spread evenly, for the median size of the specific force."""
TOO_QUIET = 1e-4
"""χ² a degree of freedom: standard errors that are stated a hundred times larger than the readings scatter."""


Found = list[tuple[Sensor, SensorCalibration]]


def doubts(known: KnownUnit, new: Checked, calibration: Calibration, but: Collection[str]) -> tuple[Doubt, ...]:
    """Everything that cannot be as the file says; none where all is plausible. ``but`` are sessions that it may share
    its moment with: itself, and the one that it replaces."""
    return (
        *of_unit(known, new, calibration.sensors, but),
        *of_date(known, new, but),
        *_of_calibration(known, new, calibration),
        *of_moment(known, new, but),
    )


def _of_calibration(known: KnownUnit, new: Checked, calibration: Calibration) -> Iterator[Doubt]:
    if new.session.programme == IN_SERVICE:
        yield from _of_recording(known, new)
    if new.session.programme not in CALIBRATIONS:
        return
    found = list(zip(new.session.sensors, calibration.sensors, strict=True))
    reference = known.reference(new.session.block, new.session.programme, new.measured_at)
    beyond = (*_of_scale(found, "nominal value", {s.name: s.nominal_scale for s, _ in found}), *_of_axes(found))
    yield from beyond
    yield from _of_bias(found)
    yield from _of_dead(calibration)
    if not beyond and reference is None:
        yield from _beside_its_type(known.store, new, found, calibration)
    elif not beyond and reference is not None:
        before = _scales(known.calibration(reference).sensors)
        yield from _of_scale(found, "value at the unit's reference", before, Remedy.BOTH)
    fit = calibration.fit
    if fit.dof > 0 and 0 < fit.chi2 / fit.dof < TOO_QUIET and new.session.standard_errors is not None:
        times = (fit.dof / fit.chi2) ** 0.5
        yield Doubt(
            say("The readings scatter {times} times less than their standard errors", times=f"{times:.0f}"),
            "another unit is stated",
        )


def _of_bias(found: Found) -> Iterator[Doubt]:
    """Zeros that no sensor has whose readings are without an offset, or have the one that the file states."""
    for sensor, estimates in found:
        bias = estimates.bias.value
        is_known = sensor.nominal_offset is not None or sensor.reading_unit.strip() in WITHOUT_OFFSET
        if is_known and bias is not None and abs(bias) > LARGEST_BIAS[sensor.kind]:
            size = in_words(sensor.kind, "bias", bias, signed=True)
            yield Doubt(say("The bias of {name} is {size}", name=sensor.name, size=size), ANOTHER)


def _of_recording(known: KnownUnit, new: Checked) -> Iterator[Doubt]:
    """A recording in service whose specific force is as many times g as a slip of units makes it."""
    session = new.session
    reference = known.reference(session.block, session.programme, new.measured_at)
    sensors = () if reference is None else known.calibration(reference).sensors
    by_name = {sensor.name: sensor for sensor in sensors if sensor.kind == ACCELEROMETER}
    places = [i for i, sensor in enumerate(session.sensors) if sensor.name in by_name]
    used = [by_name[session.sensors[i].name] for i in places]
    if len(used) < 3 or any(s.axis is None or not s.scale.value or s.bias.value is None for s in used):
        return
    rows = session.readings[:: len(session.readings) // MOST_ROWS + 1][:, places]
    offset = np.array([session.sensors[i].nominal_offset or 0.0 for i in places])
    inputs = (rows - offset) / [s.scale.value for s in used] - [s.bias.value for s in used]
    force = inputs @ np.linalg.pinv(np.array([s.axis for s in used])).T
    ratio = float(np.nanmedian(np.linalg.norm(force, axis=1))) / STANDARD_GRAVITY
    for factor in (*IN_G, *THOUSANDS):
        if factor / LIKE < ratio < factor * LIKE:
            problem = say("The specific force of the recording is {ratio} g throughout", ratio=f"{ratio:.3g}")
            yield Doubt(problem, "the readings are not in the unit of the calibration")


def _of_dead(calibration: Calibration) -> Iterator[Doubt]:
    """Channels that read the same at every position of a stand."""
    rows = len(calibration.residuals.value)
    for a in (a for a in calibration.set_aside if a.slip == STUCK and not np.isfinite(a.expected)):
        problem = (
            say("{name} has the same reading in every row, although its input changes", name=a.sensor)
            if (a.row, a.last_row) == (1, rows)
            else say(
                "{name} has the same reading in rows {row} to {last}, although its input changes",
                name=a.sensor,
                row=a.row,
                last=a.last_row,
            )
        )
        yield Doubt(problem, "the sensor is dead, or its channel is not connected")


def _beside_its_type(store: Store, new: Checked, found: Found, calibration: Calibration) -> Iterator[Doubt]:
    """The doubts about values that no other unit of its type has; none where too few are known."""
    serial = new.session.unit
    kind = UnitTypes(store).of_unit(serial)
    if _is_unnamed(new, kind) and not _is_design(found, kind):
        return
    values = History(store).references_of_type(kind.name, serial, MOST, simulated=new.session.is_simulated)
    others = type_of_references(values, tolerances_of(kind))
    scales = tuple(_of_scale(found, "value in the type's other units", others.scales(), Remedy.BOTH))
    yield from scales
    if not scales:
        yield from beside_type(calibration.sensors, others)


def _is_unnamed(new: Checked, kind: UnitType) -> bool:
    """Whether nobody said which type: it is called after what the file describes, as units of any design may be."""
    return new.session.unit_type is None and kind.name == new.type_name


def _is_design(found: Found, kind: UnitType) -> bool:
    """Whether the nominal values are those of the type, up to their rounding."""
    known = zip(kind.sensors, kind.nominal_axes, kind.nominal_scales, strict=True)
    design = {name: (np.asarray(axis), scale) for name, axis, scale in known}
    return all(
        sensor.name in design
        and sensor.nominal_axis @ design[sensor.name][0] > ROUNDED
        and 1 / LIKE < sensor.nominal_scale / design[sensor.name][1] < LIKE
        for sensor, _ in found
    )


def _of_scale(found: Found, basis: str, known: dict[str, float], remedy: Remedy = Remedy.READINGS) -> Iterator[Doubt]:
    """Scale factors far from known ones; sensors that are off alike together. ``remedy`` is what corrects readings in
    another unit: with nominal values that agree with them, both."""
    ratios = {
        sensor.name: abs(estimates.scale.value / known[sensor.name])
        for sensor, estimates in found
        if estimates.scale.value and known.get(sensor.name) and estimates.observable.get("scale")
    }
    off = {name: r for name, r in ratios.items() if not 1 / LEAST_RATIO < r < LEAST_RATIO}
    for alike in _alike(off):
        ratio = off[alike[0]]
        slip, correction = _slip(ratio, alike, remedy)
        who = (
            "Every scale factor is"
            if len(alike) == len(ratios)
            else say("The scale factor of {sensors} is", sensors=joined(", ", alike))
        )
        yield Doubt(
            say(
                "{subject_and_verb} {ratio} times its {reference}",
                subject_and_verb=who,
                ratio=f"{ratio:.4g}",
                reference=basis,
            ),
            slip,
            correction,
        )


def _alike(ratios: dict[str, float]) -> Iterator[tuple[str, ...]]:
    """The sensors in groups of about one ratio; each is in one of them, whatever its ratio."""
    left = dict(ratios)
    while left:
        first = next(iter(left))
        ratio = left.pop(first)
        others = tuple(name for name, r in left.items() if ratio / LIKE < r < ratio * LIKE)
        for name in others:
            del left[name]
        yield first, *others


def _slip(ratio: float, sensors: tuple[str, ...], remedy: Remedy) -> tuple[str, FileCorrection | None]:
    """The probable mistake behind such a ratio, and its correction."""
    for factor in THOUSANDS:
        if factor / LIKE < ratio < factor * LIKE:
            slip = "the readings are not in the unit that the file states, such as mV instead of V"
            return slip, FileCorrection(remedy, sensors, 1 / factor)
    if remedy is Remedy.BOTH:
        return "the unit or sensor is not the one in the file", None
    for factors, slip in ((IN_G, "g and m/s² were confused"), (IN_DEGREES, "degrees instead of radians")):
        for factor in factors:
            if factor / LIKE < ratio < factor * LIKE:
                return say("{slip} in the nominal scale factor", slip=slip), FileCorrection(
                    Remedy.NOMINAL, sensors, factor
                )
    return "the unit, sensor or nominal scale factor is not the one in the file", None


def _scales(sensors: Sequence[SensorCalibration]) -> dict[str, float]:
    return {s.name: s.scale.value for s in sensors if s.scale.value and s.observable.get("scale")}


def _of_axes(found: Found) -> Iterator[Doubt]:
    """Input axes that point elsewhere than the file says: along another sensor's, or backwards."""
    nominal = {sensor.name: np.asarray(sensor.nominal_axis) for sensor, _ in found}
    measured = {s.name: _axis(s) for _, s in found if s.axis is not None and s.observable.get("axis")}
    off = {name: axis for name, axis in measured.items() if axis @ nominal[name] < FAR}
    done: set[str] = set()
    for name, axis in off.items():
        other = next((o for o in off if o != name and o not in done and _exchanged(name, o, off, nominal)), None)
        if name in done:
            continue
        if -(axis @ nominal[name]) > NEAR:
            yield Doubt(
                say("{name} has the wrong sign", name=name),
                "its sign is reversed",
                FileCorrection(Remedy.READINGS, (name,), -1.0),
            )
        elif other is not None:
            done |= {name, other}
            pair = FileCorrection(Remedy.EXCHANGE, (name, other))
            yield Doubt(
                say(
                    "{name} measures along the axis of {other}, and {other} along that of {name}",
                    name=name,
                    other=other,
                ),
                EXCHANGED,
                pair,
            )
        else:
            angle = np.degrees(np.arccos(np.clip(axis @ nominal[name], -1, 1)))
            yield Doubt(
                say("{name} measures {angle}° away from its nominal axis", name=name, angle=f"{angle:.0f}"),
                "the nominal axis, mounting or channel is wrong",
            )


EXCHANGED = "their channels are exchanged"


def _axis(sensor: SensorCalibration) -> Array:
    """Along which the sensor reads more, as its positive nominal scale factor says."""
    sign = -1.0 if (sensor.scale.value or 1.0) < 0 else 1.0
    return sign * np.asarray(sensor.axis)


def _exchanged(sensor: str, other: str, measured: dict[str, Array], nominal: dict[str, Array]) -> bool:
    return bool(measured[sensor] @ nominal[other] > NEAR and measured[other] @ nominal[sensor] > NEAR)
