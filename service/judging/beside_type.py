"""Step: a session that would become a reference beside the other units of its type: can it be one of them?

Sensor by sensor it is compared with the references of the type's other units: scale factor, zero, nonlinearity,
direction and their uncertainties. The distance that counts as far follows the type: it is measured in the spread of its
units (robust, less the uncertainty of the sessions) or in the tolerance, whichever is wider.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from estimator.health.population import spread
from estimator.message import joined, say
from estimator.results import SensorCalibration
from estimator.session import Array
from service.kit.measures import MEASURES, in_words
from service.sessions.doubt import Doubt
from service.sessions.records import ParameterValue

FEWEST = 5
"""Other units: with fewer, two unlike ones would be most of the type."""
MOST = 60
"""References, the newest: enough for a spread, and a millisecond to read."""
FAR = 50.0
"""Multiple of the spread, and of the tolerance, that no unit of a type lies apart: a mistaken factor gives a hundred
and more, and smaller changes of a unit are judged by its tolerances later.
"""
COARSE = 100.0
"""Ratio of uncertainties beyond what more positions or longer averages can do: ten thousand times the readings."""
RAYLEIGH = 1.1774
"""Median of the length of a two-vector, in sigmas of a component."""
NEAR = float(np.cos(np.radians(10.0)))
"""Cosine of the angle within which an axis is taken for that of a sensor."""
ANOTHER = "the readings contain an offset, or the connected sensor is not the one in the file"
Tolerances = Mapping[tuple[str, str], float]
"""Tolerances by kind of sensor and parameter, SI or relative."""


@dataclass(frozen=True)
class Type:
    """Values in the references of other units."""

    values: Mapping[tuple[str, str], tuple[ParameterValue, ...]]
    """Values by sensor and parameter, only where enough units have them."""
    tolerances: Tolerances

    def scales(self) -> dict[str, float]:
        """The median scale factor of each sensor."""
        return {name: float(np.median([v.value for v in known])) for (name, parameter), known in self.values.items()
                if parameter == "scale"}  # fmt: skip

    def far(self, kind: str, parameter: str, width: float) -> float:
        """The distance that no unit reaches, unit of the parameter."""
        return FAR * max(width, self.tolerances.get((kind, parameter), 0.0))


def type_of_references(values: Sequence[ParameterValue], tolerances: Tolerances) -> Type:
    """The type from the values of other units' references."""
    grouped: dict[tuple[str, str], list[ParameterValue]] = {}
    for value in values:
        if value.value is not None or value.axis is not None:
            grouped.setdefault((value.sensor, value.parameter), []).append(value)
    return Type({key: tuple(known) for key, known in grouped.items() if len(known) >= FEWEST}, tolerances)


def beside_type(sensors: Sequence[SensorCalibration], peers: Type) -> Iterator[Doubt]:
    """The doubts about values that no unit of the type has, except scale factors."""
    for parameter, name in (("bias", "bias"), ("quadratic", "quadratic term")):
        away = {s.name: d for s in sensors if (d := _distance(s, parameter, peers)) is not None}
        if away:
            kind = next(s.kind for s in sensors if s.name in away)
            who, most = joined(", ", away), in_words(kind, parameter, max(away.values(), key=abs))
            yield Doubt(
                say(
                    "The {name} of {sensors} differs by {distance} from the other units of the type",
                    name=name,
                    sensors=who,
                    distance=most,
                ),
                ANOTHER,
            )
    yield from _directions(sensors, peers)
    yield from _uncertainties(sensors, peers)


def _distance(sensor: SensorCalibration, parameter: str, peers: Type) -> float | None:
    """The distance of a value from the type's median, SI, where it is too far; None otherwise."""
    known, seen = peers.values.get((sensor.name, parameter), ()), getattr(sensor, parameter)
    if not known or seen.value is None or (sensor.kind, parameter) not in MEASURES:
        return None
    centre, width = spread(np.array([v.value for v in known]), np.array([v.u or 0.0 for v in known]))
    away = float(seen.value - centre)
    return away if abs(away) > peers.far(sensor.kind, parameter, float(np.hypot(width, seen.sigma or 0.0))) else None


def _directions(sensors: Sequence[SensorCalibration], peers: Type) -> Iterator[Doubt]:
    """Axes that point where the type's do not."""
    means = {name: _mean(known) for (name, parameter), known in peers.values.items() if parameter == "axis"}
    for sensor in sensors:
        if sensor.axis is None or sensor.name not in means:
            continue
        angle = _angle(sensor.axis, means[sensor.name])
        others = [_angle(np.array(v.axis), means[sensor.name]) for v in peers.values[sensor.name, "axis"]]
        if angle <= peers.far(sensor.kind, "axis", float(np.median(others)) / RAYLEIGH):
            continue
        other = next((o for o, mean in means.items() if o != sensor.name and sensor.axis @ mean > NEAR), None)
        where = "" if other is None else say(", along the axis of {other}", other=other)
        yield Doubt(
            say(
                "{name} points {kind} away from its direction in the other units of the type{direction}",
                name=sensor.name,
                kind=in_words(sensor.kind, "axis", angle),
                direction=where,
            ),
            "sensors or axes have other names than in the type" if other else "nominal axis or mounting is wrong",
        )


def _uncertainties(sensors: Sequence[SensorCalibration], peers: Type) -> Iterator[Doubt]:
    """Zeros that are known hundreds of times better or worse."""
    ratios = []
    for sensor in sensors:
        usual = [v.u for v in peers.values.get((sensor.name, "bias"), ()) if v.u]
        if usual and sensor.bias.sigma:
            ratios.append(sensor.bias.sigma / float(np.median(usual)))
    ratio = float(np.median(ratios)) if ratios else 1.0
    if not 1 / COARSE < ratio < COARSE:
        times = (
            say("{ratio} times less certain", ratio=f"{max(ratio, 1 / ratio):.0f}")
            if ratio > 1
            else say("{ratio} times more certain", ratio=f"{max(ratio, 1 / ratio):.0f}")
        )
        yield Doubt(
            say("Its biases are {times} than in the other units of the type", times=times),
            "the standard errors are in another unit, or the readings are not the measured ones",
        )


def _mean(values: Sequence[ParameterValue]) -> Array:
    """(3,) direction about which a sensor's axes lie, dimensionless."""
    middle = np.median(np.array([v.axis for v in values]), axis=0)
    return np.asarray(middle / np.linalg.norm(middle))


def _angle(axis: Array, mean: Array) -> float:
    """rad."""
    return float(np.arctan2(np.linalg.norm(np.cross(axis, mean)), axis @ mean))
