"""Bias and scale factor over temperature in words, and the findings beside the curves."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import isfinite

import numpy as np

from estimator.curves import HYSTERESIS, LAG, Curve, ThermalCurves, ThermalFinding
from estimator.message import joined, say
from estimator.results import Calibration
from estimator.session import Array
from service.kit.measures import COVERAGE, deviation_measure, measured

NAMES = {"scale": "scale factor", "bias": "bias"}
"""Names of the parameters that follow temperature."""
MINUTE = 60.0
"""Seconds in a minute."""


@dataclass(frozen=True)
class CurveRow:
    """One parameter of one sensor over temperature."""

    sensor: str
    parameter: str
    order: int
    """Order of the polynomial."""
    cold: str
    """Change from the reference to the lowest temperature, ± U of the value there."""
    hot: str
    """Change from the reference to the highest temperature, ± U of the value there."""


@dataclass(frozen=True)
class CurvesInWords:
    """Curves of a thermal session, in words."""

    reference: str
    """Temperature that all other numbers of the session hold at."""
    lowest: str
    highest: str
    rows: tuple[CurveRow, ...]
    findings: tuple[str, ...]


def celsius(temperature: float) -> str:
    """``−40 °C``."""
    return f"{temperature:.3g} °C".replace("-", "−")


def curves_in_words(calibration: Calibration) -> CurvesInWords | None:
    """The curves of a session; None where it holds none."""
    curves = calibration.thermal
    if curves is None:
        return None
    return CurvesInWords(
        reference=celsius(curves.reference_temperature),
        lowest=celsius(curves.lowest),
        highest=celsius(curves.highest),
        rows=tuple(_rows(calibration, curves)),
        findings=tuple(_findings(calibration, curves)),
    )


def change(curves: ThermalCurves, curve: Curve, parameter: str, temperature: Array) -> tuple[Array, Array]:
    """Change from the reference temperature and U of the value, (n,) each, relative for a scale factor, else SI."""
    nominal = float(curve.coefficients[0]) if parameter == "scale" else 1.0
    moved = curves.value(curve, temperature) - curve.coefficients[0]
    return moved / nominal, curves.expanded(curve, temperature, COVERAGE) / abs(nominal)


def _rows(calibration: Calibration, curves: ThermalCurves) -> Iterator[CurveRow]:
    kinds = {sensor.name: sensor.kind for sensor in calibration.sensors}
    ends = np.array([curves.lowest, curves.highest])
    for sensor in curves.sensors:
        for parameter, curve in (("bias", sensor.bias), ("scale", sensor.scale)):
            if curve is None:
                continue
            moved, spread = change(curves, curve, parameter, ends)
            measure = deviation_measure(kinds[sensor.name], parameter, float(np.abs(moved).max()))
            cold, hot = (measured(float(m), float(u), measure) for m, u in zip(moved, spread, strict=True))
            yield CurveRow(sensor.name, NAMES[parameter], curve.order, cold, hot)


def _findings(calibration: Calibration, curves: ThermalCurves) -> Iterator[str]:
    """One sentence a kind and parameter, of all its sensors, with the largest."""
    groups: dict[tuple[str, str], list[ThermalFinding]] = {}
    for found in curves.findings:
        groups.setdefault((found.kind, found.parameter), []).append(found)
    for (kind, parameter), group in groups.items():
        largest = max(group, key=lambda found: abs(found.amplitude))
        nominal = calibration.sensor(largest.sensor).scale.value if parameter == "scale" else 1.0
        size, spread = abs(largest.amplitude / (nominal or 1.0)), COVERAGE * largest.sigma
        measure = deviation_measure(calibration.sensor(largest.sensor).kind, parameter, size)
        words = measured(size, spread if isfinite(spread) and spread > 0 else None, measure)
        sensors = joined(", ", dict.fromkeys(found.sensor for found in group))
        yield _sentence(kind, sensors, words, largest)


def _sentence(kind: str, sensors: str, size: str, largest: ThermalFinding) -> str:
    if kind == HYSTERESIS:
        said = say(
            "Hysteresis of {sensors}: warming and cooling differ by up to {size} in the middle of the range. Half of "
            "it is in the band.",
            sensors=sensors,
            size=size,
        )
        other = say("A lag explains it nearly as well.")
    elif kind == LAG:
        said = say(
            "The bias of {sensors} lags the temperature, time constant {minutes} min, by up to {size}. Change the "
            "temperature more slowly, or soak longer before measuring.",
            sensors=sensors,
            minutes=f"{(largest.time_constant or 0.0) / MINUTE:.2g}",
            size=size,
        )
        other = say("Hysteresis explains it nearly as well.")
    else:
        return say(
            "The {parameter} of {sensors} departs from its curve by up to {size} (one sigma), which is in the band. "
            "Measure at more temperatures.",
            parameter=NAMES[largest.parameter],
            sensors=sensors,
            size=size,
        )
    return say("{first} {second}", first=said, second=other) if largest.alternatives else said
