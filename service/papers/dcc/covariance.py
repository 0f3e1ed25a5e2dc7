"""The joint covariance of all parameters, row by row: what a program needs that combines them."""

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from estimator.session import ACCELEROMETER
from service.kit.xml import Element
from service.papers.certified import CertifiedSession
from service.papers.dcc.elements import DCC, SI, english, plain
from service.papers.dcc.quantities import ONE, value_measure

FACTOR = re.compile(r"((?:\\milli)?\\(?!milli|tothe|one)[a-z]+)(?:\\tothe\{(-?\d+)\})?")
"""One unit of a product in D-SI, with its exponent."""
TOTAL = "Covariance of all parameters"
TRIANGLE = "Each entry with itself and those after it: the matrix is symmetric. Labels name the other parameter."


def covariance(found: CertifiedSession) -> Element | None:
    """The observed parameters' total covariance; None where the session tells no noise."""
    calibration, units = found.report.calibration, _units(found)
    matrix = np.asarray(calibration.covariance, dtype=float)
    seen = [k for k, unit in enumerate(units) if unit and np.isfinite(matrix[k, k])]
    if not seen:
        return None
    rows = (
        _row(
            calibration.names[k],
            [Entry(_word(calibration.names[j]), matrix[k, j], product(units[k], units[j])) for j in seen[place:]],
        )
        for place, k in enumerate(seen)
    )
    data = DCC.data(*(part for row in rows for part in row))
    return DCC.result(english("name", TOTAL), english("description", TRIANGLE), data)


@dataclass(frozen=True)
class Entry:
    """One element of the covariance."""

    label: str
    """The other parameter."""
    value: float
    unit: str


def _row(name: str, entries: Sequence[Entry]) -> Iterator[Element]:
    """The covariances of one parameter, a list for each unit."""
    for unit in dict.fromkeys(entry.unit for entry in entries):
        own = [entry for entry in entries if entry.unit == unit]
        numbers = SI.realListXMLList(
            SI.labelXMLList(" ".join(entry.label for entry in own)),
            SI.valueXMLList(" ".join(repr(float(entry.value)) for entry in own)),
            SI.unitXMLList(unit),
        )
        yield DCC.quantity(english("name", f"covariance of {name}"), numbers)


def _units(found: CertifiedSession) -> list[str]:
    """D-SI of every element of the covariance; empty where it belongs to no sensor."""
    kinds = {sensor.name: sensor.kind for sensor in found.report.calibration.sensors}
    readings = {sensor.name: sensor.reading_unit for sensor in found.source.sensors}
    counts = found.source.count_time is not None
    units = []
    for name in found.report.calibration.names:
        sensor, _, element = name.rpartition(".")
        kind = kinds.get(sensor, "")
        counted = counts and kind != ACCELEROMETER
        units.append(value_measure(kind, element, readings.get(sensor, ""), counted=counted) if kind else "")
    return units


def product(first: str, second: str) -> str:
    """The product of two units in D-SI, every unit once."""
    powers: Counter[str] = Counter()
    for unit, power in FACTOR.findall(first) + FACTOR.findall(second):
        powers[unit] += int(power or 1)
    written = (unit if power == 1 else f"{unit}\\tothe{{{power}}}" for unit, power in powers.items() if power)
    return "".join(written) or ONE


def _word(name: str) -> str:
    """A name as one entry of a list."""
    return "_".join(plain(name).split())
