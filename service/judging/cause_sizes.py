"""Size of a named cause in the unit of a tolerance: its effect on a zero, a scale factor or a direction.

A cause that acts at the input counts by its contribution to a reading: a coefficient times the variable in the session.
That variable is the span of time or temperature from end to end, for a square that of half the span about the middle,
or the input itself. A cause that scales the input counts as a relative change, one that turns something as an angle.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import exp, hypot, isfinite, sqrt

import numpy as np
from numpy.typing import NDArray

from estimator.applied_vector import EARTH_RATE, STANDARD_GRAVITY
from estimator.causes import find
from estimator.diagnosis import Finding
from estimator.diagnosis.results import Structure
from estimator.health.rule import tolerance_of
from estimator.results import Calibration, Residuals
from estimator.session import ACCELEROMETER, GYROSCOPE
from service.kit.measures import leading_kind

INPUTS = {ACCELEROMETER: STANDARD_GRAVITY, GYROSCOPE: EARTH_RATE}
"""Largest input of a sensor on a stand or at rest, m/s² (rad/s)."""
ACTS_ON = {
    "1": ("scale", "nothing"),
    "1/K": ("scale", "temperature"),
    "1/K²": ("scale", "temperature²"),
    "1/s": ("scale", "time"),
    "input": ("bias", "nothing"),
    "input/K": ("bias", "temperature"),
    "input/K²": ("bias", "temperature²"),
    "input/s": ("bias", "time"),
    "input/(K/s)": ("bias", "warming"),
    "(input)⁻¹": ("bias", "input²"),
    "(input)⁻²": ("bias", "input³"),
    "(input)/(m/s²)": ("bias", "gravity"),
    "rad": ("axis", "nothing"),
}
"""Parameter whose tolerance an amplitude is held against, and the variable in the session that multiplies it, by the
amplitude's SI unit. ``input`` is m/s² or rad/s.
"""


@dataclass(frozen=True)
class Size:
    """Size of an effect beside a tolerance."""

    sensors: tuple[str, ...]
    """Sensor where it is largest; empty for an effect on all."""
    kind: str
    """Kind of the sensor."""
    parameter: str
    value: float
    """SI; relative for a scale factor."""
    sigma: float | None
    """Standard uncertainty; None where it is not known."""
    tolerance: float

    @property
    def share(self) -> float:
        """Share of the tolerance."""
        return self.value / self.tolerance


@dataclass(frozen=True)
class Yardstick:
    """Basis of sizes: calibration, residuals and tolerances."""

    calibration: Calibration
    residuals: Residuals
    """Residuals under the baseline."""
    tolerances: Mapping[tuple[str, str], float]
    """Tolerances by kind of sensor, or sensor, and parameter."""


def size_of_cause(finding: Finding, yardstick: Yardstick) -> Size | None:
    """The largest size of a named cause by its share of a tolerance; None where no tolerance is set for its effects."""
    return max(_sizes(finding, yardstick), key=lambda size: size.share, default=None)


def size_of_structure(structure: Structure, yardstick: Yardstick) -> Size | None:
    """The root mean square of unexplained structure at the input, as a zero; None where nothing says it."""
    if structure.course is not None and structure.course.components:
        kind = _leading(yardstick)
        angles = np.array(structure.course.values)
        return _beside(
            yardstick, (), kind, "bias", (INPUTS[kind] * float(np.sqrt(np.mean(np.sum(angles**2, axis=1)))), None)
        )
    return _by_strength(structure.sensors, structure.strength, yardstick)


def _sizes(finding: Finding, yardstick: Yardstick) -> Iterator[Size]:
    """The sizes for every sensor that the cause acts on, or for all together."""
    count = max(1, len(finding.sensors))
    width = len(finding.amplitude) // count
    known = find(finding.cause)
    if not width or known is None or known.clips or "vibration" in known.needs:
        size = _by_strength(finding.sensors, finding.strength, yardstick)
        yield from () if size is None else (size,)
        return
    for k in range(count):
        sensors, part = finding.sensors[k : k + 1], slice(k * width, (k + 1) * width)
        kind = yardstick.calibration.sensor(sensors[0]).kind if sensors else _leading(yardstick)
        found = _of_sensor(finding, part, kind, yardstick, _left(finding, k))
        size = None if found is None else _beside(yardstick, sensors, kind, *found)
        yield from () if size is None else (size,)


def _of_sensor(
    finding: Finding, part: slice, kind: str, yardstick: Yardstick, left: float
) -> tuple[str, tuple[float, float | None]] | None:
    """The parameter, and the length of a sensor's amplitudes with its sigma, of which a share is left in the session;
    None where it is nothing."""
    parameter, times = _effect(finding.cause, finding.units[part][0], kind, yardstick.residuals)
    times *= left
    value = hypot(*(x for x in finding.amplitude[part] if isfinite(x)))
    if parameter is None or value == 0:
        return None
    spread = hypot(*(a * s / value for a, s in zip(finding.amplitude[part], finding.sigma[part], strict=True)))
    return parameter, (value * times, spread * times if isfinite(spread) else None)


def _left(finding: Finding, k: int) -> float:
    """The share of the k-th sensor's amplitude that is left at the first row: 1 but of what settles since power-on."""
    if finding.since_power_on is None:
        return 1.0
    shapes = finding.nonlinear_each
    return exp(-finding.since_power_on / shapes[k if len(shapes) > 1 else 0]["s"])


def _effect(cause: str, unit: str, kind: str, residuals: Residuals) -> tuple[str | None, float]:
    """The parameter that an amplitude is held against, and the factor on it."""
    known = find(cause)
    if known is not None and known.grows_an_angle:
        return "axis", _span(residuals.time)
    if known is not None and known.scope == "stand" and unit == "1":
        return "axis", _span(residuals.beta)
    parameter, factor = ACTS_ON.get(by_input(unit), (None, "nothing"))
    return parameter, _times(factor, kind, residuals)


def by_input(unit: str) -> str:
    """The unit in terms of the input, ``input/K`` for ``m/s²/K``; a unit per specific force stays so."""
    head = unit.removesuffix("/(m/s²)")
    return f"{head.replace('m/s²', 'input').replace('rad/s', 'input')}{unit[len(head) :]}"


def _times(factor: str, kind: str, residuals: Residuals) -> float:
    match factor:
        case "temperature":
            return _span(residuals.temperature)
        case "temperature²":
            return (_span(residuals.temperature) / 2) ** 2
        case "time":
            return _span(residuals.time)
        case "warming":
            return _span(_slope(residuals))
        case "input²":
            return INPUTS[kind] ** 2
        case "input³":
            return INPUTS[kind] ** 3
        case "gravity":
            return STANDARD_GRAVITY
        case _:
            return 1.0


def _slope(residuals: Residuals) -> NDArray[np.float64] | None:
    """(R,) dT/dt, °C/s."""
    if residuals.temperature is None or residuals.time is None:
        return None
    return np.asarray(np.gradient(residuals.temperature, residuals.time))


def _span(column: NDArray[np.float64] | None) -> float:
    return 0.0 if column is None else float(np.ptp(column))


def _by_strength(sensors: tuple[str, ...], strength: float, yardstick: Yardstick) -> Size | None:
    """The root mean square at the input of an effect of so many standard errors, over the rows of its sensors."""
    names = [sensor.name for sensor in yardstick.calibration.sensors]
    places = [names.index(name) for name in sensors if name in names] or list(range(len(names)))
    errors = yardstick.residuals.sigma[:, places]
    kind = yardstick.calibration.sensors[places[0]].kind if sensors else _leading(yardstick)
    rms = strength * float(np.sqrt(np.mean(errors**2))) / sqrt(errors.size)
    return _beside(yardstick, sensors, kind, "bias", (rms, None)) if isfinite(rms) else None


def _leading(yardstick: Yardstick) -> str:
    return leading_kind({sensor.kind for sensor in yardstick.calibration.sensors})


def _beside(
    yardstick: Yardstick, sensors: tuple[str, ...], kind: str, parameter: str, size: tuple[float, float | None]
) -> Size | None:
    """A size, with its standard uncertainty, beside the tolerance; None where there is none."""
    tolerance = tolerance_of(yardstick.tolerances, sensors[0] if sensors else "", kind, parameter)
    return None if tolerance is None else Size(sensors, kind, parameter, *size, tolerance)
