"""Step: before a session is judged or becomes a reference: can it be as its file says?

Scale factors, axes, signs, noise and date against the file's own nominal values and the unit's reference; temperature
and gravity are held against what the Earth allows when the file is read. Only what no sensor and no stand can do is
doubted: a doubt is a slip of writing down, not a fault of the unit, which its tolerances judge.
"""

from collections.abc import Iterator
from datetime import UTC, datetime

import numpy as np

from estimator.applied_vector import STANDARD_GRAVITY
from estimator.results import Calibration, SensorCalibration
from estimator.session import CALIBRATIONS, Array, Sensor
from service.ingest.checked import Checked
from service.judging.reference import reference_of
from service.records.doubt import Correction, Doubt, Remedy
from service.storage.store import Store

LEAST_RATIO = 2.0
"""Of a scale factor to its nominal: makers state it within some percent, and no sensor loses half of it and works."""
LIKE = 1.2
"""Ratios within this factor of one another are one slip; nominal values are rounded."""
THOUSANDS = (1e3, 1e-3, 1e6, 1e-6)
IN_G = (STANDARD_GRAVITY, 1 / STANDARD_GRAVITY)
IN_DEGREES = (180 / np.pi, np.pi / 180)
FAR, NEAR = np.cos(np.radians(20.0)), np.cos(np.radians(10.0))
"""An input axis lies within some degrees of its nominal one: beyond 20° it is another one, within 10° it is that."""
TOO_QUIET = 1e-5
"""χ² a degree of freedom: standard errors that are stated 300 times larger than the readings scatter."""
FIRST_CLOCK = datetime(1980, 1, 7, tzinfo=UTC)
"""Clocks that lost their time start in 1970, or in 1980 with GPS; there was no session file then."""


def doubts(store: Store, new: Checked, calibration: Calibration) -> tuple[Doubt, ...]:
    """Everything that cannot be as the file says; none where all is plausible."""
    return (*_of_date(new), *_of_calibration(store, new, calibration))


def _of_date(new: Checked) -> Iterator[Doubt]:
    if new.measured_at < FIRST_CLOCK:
        day = f"{new.measured_at:%Y-%m-%d}"
        yield Doubt(f"It is dated {day}", "the clock had lost its time; put the date of the measurement into the file")


def _of_calibration(store: Store, new: Checked, calibration: Calibration) -> Iterator[Doubt]:
    if new.session.programme not in CALIBRATIONS:
        return
    found = list(zip(new.session.sensors, calibration.sensors, strict=True))
    scales = tuple(_of_scale(found, "nominal value", {s.name: s.nominal_scale for s, _ in found}))
    yield from scales
    if not scales:
        yield from _of_scale(found, "value at the unit's reference", _known_scales(store, new))
    yield from _of_axes(found)
    fit = calibration.fit
    if fit.dof > 0 and 0 < fit.chi2 / fit.dof < TOO_QUIET and new.session.standard_errors is not None:
        times = (fit.dof / fit.chi2) ** 0.5
        yield Doubt(f"The readings scatter {times:.0f} times less than their standard errors", "another unit is stated")


Found = list[tuple[Sensor, SensorCalibration]]


def _of_scale(found: Found, what: str, known: dict[str, float]) -> Iterator[Doubt]:
    """Scale factors far from known ones; sensors that are off alike together."""
    ratios = {
        sensor.name: abs(own.scale.value / known[sensor.name])
        for sensor, own in found
        if own.scale.value and known.get(sensor.name) and own.observable.get("scale")
    }
    off = {name: r for name, r in ratios.items() if not 1 / LEAST_RATIO < r < LEAST_RATIO}
    while off:
        ratio = next(iter(off.values()))
        alike = tuple(name for name, r in off.items() if ratio / LIKE < r < ratio * LIKE)
        off = {name: r for name, r in off.items() if name not in alike}
        slip, correction = _slip(ratio, alike)
        who = "Every scale factor is" if len(alike) == len(ratios) else f"The scale factor of {', '.join(alike)} is"
        yield Doubt(f"{who} {ratio:.4g} times its {what}", slip, correction)


def _slip(ratio: float, sensors: tuple[str, ...]) -> tuple[str, Correction | None]:
    """What makes such a ratio, and what takes it back."""
    for factor in THOUSANDS:
        if factor / LIKE < ratio < factor * LIKE:
            slip = "the readings are in another unit than the file says, such as mV for V"
            return slip, Correction(Remedy.READINGS, sensors, 1 / factor)
    for factors, slip in ((IN_G, "g and m/s² were taken for one another"), (IN_DEGREES, "degrees stand for radians")):
        for factor in factors:
            if factor / LIKE < ratio < factor * LIKE:
                return f"{slip} in the nominal scale factor", Correction(Remedy.NOMINAL, sensors, factor)
    return "unit, sensor or nominal scale factor is another one than the file says", None


def _known_scales(store: Store, new: Checked) -> dict[str, float]:
    """Scale factors of the reference in force when the session was measured; none before the first."""
    session = new.session
    if not store.units.exists(session.unit):
        return {}
    unit = store.units.key(session.unit)
    reference = reference_of(store, unit, session.block, session.programme, new.measured_at).session
    sensors = () if reference is None else store.calibrations.get(reference).sensors
    return {s.name: s.scale.value for s in sensors if s.scale.value and s.observable.get("scale")}


def _of_axes(found: Found) -> Iterator[Doubt]:
    """Input axes that point elsewhere than the file says: along another sensor's, or backwards."""
    nominal = {sensor.name: np.asarray(sensor.nominal_axis) for sensor, _ in found}
    measured = {own.name: _axis(own) for _, own in found if own.axis is not None and own.observable.get("axis")}
    off = {name: axis for name, axis in measured.items() if axis @ nominal[name] < FAR}
    done: set[str] = set()
    for name, axis in off.items():
        other = next((o for o in off if o != name and o not in done and _exchanged(name, o, off, nominal)), None)
        if name in done:
            continue
        if -(axis @ nominal[name]) > NEAR:
            yield Doubt(f"{name} reads backwards", "its sign is reversed", Correction(Remedy.READINGS, (name,), -1.0))
        elif other is not None:
            done |= {name, other}
            pair = Correction(Remedy.EXCHANGE, (name, other))
            yield Doubt(f"{name} feels along the axis of {other}, and {other} along that of {name}", EXCHANGED, pair)
        else:
            angle = np.degrees(np.arccos(np.clip(axis @ nominal[name], -1, 1)))
            yield Doubt(
                f"{name} feels {angle:.0f}° from its nominal axis", "nominal axis, mounting or channel is wrong"
            )


EXCHANGED = "their channels are exchanged"


def _axis(own: SensorCalibration) -> Array:
    """Along which the sensor reads more, as its positive nominal scale factor says."""
    sign = -1.0 if (own.scale.value or 1.0) < 0 else 1.0
    return sign * np.asarray(own.axis)


def _exchanged(one: str, other: str, measured: dict[str, Array], nominal: dict[str, Array]) -> bool:
    return bool(measured[one] @ nominal[other] > NEAR and measured[other] @ nominal[one] > NEAR)
